// Meshes: STL and OBJ files, their convex hulls, masses and inertias.
#include <orthant/core/mechanics/models/hulls.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <numbers>

using namespace orthant;
using models::Mesh;

namespace {

/// Twelve triangles, counter-clockwise from outside.
std::vector<spatial::Triangle> box_surface(const Vector3d& size) {
  const auto corner = [&](int i) {
    return Vector3d((i & 1) != 0 ? size.x() : 0, (i & 2) != 0 ? size.y() : 0, (i & 4) != 0 ? size.z() : 0);
  };
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<spatial::Triangle> all;
  for (const auto& f : kFaces) {
    all.push_back({corner(f[0]), corner(f[1]), corner(f[2])});
    all.push_back({corner(f[0]), corner(f[2]), corner(f[3])});
  }
  return all;
}

std::string as_stl(const std::vector<spatial::Triangle>& surface) {
  std::string bytes(84, ' ');
  const auto count = static_cast<std::uint32_t>(surface.size());
  std::memcpy(bytes.data() + 80, &count, 4);
  for (const spatial::Triangle& t : surface) {
    std::array<float, 12> x{};
    for (std::size_t k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) x[3 + 3 * k + static_cast<std::size_t>(i)] = static_cast<float>(t[k][i]);
    bytes.append(reinterpret_cast<const char*>(x.data()), sizeof x).append(2, '\0');
  }
  return bytes;
}

std::string as_stl_text(const std::vector<spatial::Triangle>& surface) {
  std::string text = "solid box\n";
  for (const spatial::Triangle& t : surface) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const Vector3d& p : t)
      text += "   vertex " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid box\n";
}

std::string refusal_of_mesh(const char* kind, const std::string& bytes) {
  try {
    static_cast<void>(models::read_mesh(bytes, std::string("x.") + kind));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a box as a mesh: mass and inertia of the box, from STL, STL text, OBJ, and turned about") {
  const Vector3d size(0.5, 0.25, 2);  // single numbers hold them
  const spatial::Solid exact = spatial::box(size);
  const auto surface = box_surface(size);
  const std::string obj =
      "# a box\no box\nv 0 0 0\nv 0.5 0 0\nv 0.5 0.25 0\nv 0 0.25 0\nv 0 0 2\nv 0.5 0 2\nv 0.5 0.25 2\nv 0 0.25 2\n"
      "vn 0 0 1\nf 1 4 3 2\nf 5//1 6//1 7//1 8//1\nf 1/1/1 2/1/1 6/1/1 5/1/1\nf -5 -1 -2 -6\nf 1 5 8 4\nf 2 3 7 6\n";
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"box.stl", as_stl(surface)},
                                    {"box.STL", as_stl_text(surface)},
                                    {"box.obj", obj}}) {
    CAPTURE(name);
    const Mesh mesh = models::read_mesh(bytes, name);
    CHECK(mesh.surface.size() == 12);
    CHECK(models::closed(mesh));
    for (const Vector3d& scale : {Vector3d(1, 1, 1), Vector3d(-1, 1, 1), Vector3d(2, -3, 0.5)}) {
      const models::MeshHull hull = models::hull_of_mesh(mesh, scale, name);
      const spatial::Solid wanted = spatial::box(size.cwiseProduct(scale.cwiseAbs()));
      CHECK(hull.corners.size() == 8);
      CHECK(hull.note.empty());
      CHECK(hull.solid.volume == doctest::Approx(wanted.volume).epsilon(1e-14));
      CHECK((hull.solid.centre - size.cwiseProduct(scale) / 2).norm() < 1e-15);
      CHECK((hull.solid.inertia - wanted.inertia).norm() < 1e-14 * wanted.inertia.norm());
    }
  }
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  auto turned = surface;
  for (auto& t : turned)
    for (Vector3d& p : t) p = R * p + Vector3d(3, -4, 5);
  const spatial::Polyhedron p = spatial::polyhedron(turned);
  CHECK(p.volume == doctest::Approx(exact.volume).epsilon(1e-13));
  CHECK((p.inertia - R * exact.inertia * R.transpose()).norm() < 1e-12);
}

TEST_CASE("a tetrahedron's inertia is the textbook's") {
  // 0, a x, b y, c z: V = a b c / 6, centre a/4, b/4, c/4, J_x = 3 (b² + c²) / 80.
  const double a = 2, b = 3, c = 5;
  const spatial::Hull hull = spatial::hull_of({{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}});
  const spatial::Polyhedron p = spatial::polyhedron(hull);
  CHECK(p.volume == doctest::Approx(a * b * c / 6).epsilon(1e-14));
  CHECK((p.centre - Vector3d(a, b, c) / 4).norm() < 1e-14);
  CHECK(p.inertia(0, 0) == doctest::Approx(3 * (b * b + c * c) / 80).epsilon(1e-13));
  CHECK(p.inertia(0, 1) == doctest::Approx(a * b / 80).epsilon(1e-13));
}

TEST_CASE("hulls of many points: all corners where there are few, else the ones that leave least outside") {
  std::vector<Vector3d> grid;
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j)
      for (int k = 0; k <= 10; ++k) grid.emplace_back(0.1 * i, 0.03 * j, 2.0 * k);
  const spatial::FittedHull box = spatial::fit_hull(grid);
  CHECK(box.hull.corners.size() == 8);
  CHECK(box.outside == 0);
  std::vector<Vector3d> pyramid = grid;
  pyramid.emplace_back(1.0000001, 0.1, 7.3);  // a corner that no coarse direction finds
  const spatial::FittedHull more = spatial::fit_hull(pyramid);
  CHECK(more.hull.corners.size() == 9);
  CHECK(more.outside == 0);
  std::vector<Vector3d> sphere;
  for (int i = 0; i < 5000; ++i) {
    const double z = 1 - (2 * i + 1) / 5000.0, turn = 2.4 * i, r = std::sqrt(1 - z * z);
    sphere.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  const spatial::FittedHull ball = spatial::fit_hull(sphere);
  CHECK(ball.hull.corners.size() <= spatial::kMostHullPoints);
  CHECK(ball.outside > 0.02);
  CHECK(ball.outside < 0.2);
  CHECK(spatial::polyhedron(ball.hull).volume > 0.85 * 4 / 3 * std::numbers::pi);
  for (const Vector3d& p : sphere) CHECK_FALSE(ball.hull.depth_of(p) > ball.outside);
  CHECK_THROWS_AS(static_cast<void>(spatial::fit_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})), std::invalid_argument);
  std::vector<Vector3d> flat;
  for (int i = 0; i < 100; ++i) flat.emplace_back(std::cos(i), std::sin(i), std::cos(i) - 2 * std::sin(i));
  CHECK_THROWS_AS(static_cast<void>(spatial::fit_hull(flat)), std::invalid_argument);
  CHECK(spatial::flat_hull(flat).size() == 100);
  CHECK(spatial::flat_hull({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}).empty());
}

TEST_CASE("a mesh that is open or dented is taken as its convex hull, with a note") {
  auto surface = box_surface({1, 1, 1});
  Mesh dented;
  dented.surface = surface;
  for (spatial::Triangle& t : dented.surface)
    for (Vector3d& p : t) {
      if (p == Vector3d(1, 1, 1)) p = {0.6, 0.6, 0.6};
      dented.points.push_back(p);
    }
  const models::MeshHull dent = models::hull_of_mesh(dented, {1, 1, 1}, "dent.stl");
  CHECK(dent.note.find("dent.stl: is not convex: meets others as its convex hull, ") == 0);
  Mesh open;
  surface.pop_back();
  for (const spatial::Triangle& t : open.surface = surface) open.points.insert(open.points.end(), t.begin(), t.end());
  const models::MeshHull hull = models::hull_of_mesh(open, {1, 1, 1}, "open.stl");
  CHECK(hull.note == "open.stl: the surface is not closed: taken as its convex hull");
  CHECK(hull.solid.volume == doctest::Approx(1).epsilon(1e-14));

  Mesh turned;
  for (const spatial::Triangle& t : box_surface({1, 1, 1})) {
    turned.surface.push_back({t[0], t[2], t[1]});
    turned.points.insert(turned.points.end(), t.begin(), t.end());
  }
  CHECK(models::hull_of_mesh(turned, {1, 1, 1}, "turned.stl").note ==
        "turned.stl: the surface is inside out (corners clockwise, seen from outside): taken as its convex hull");
}

TEST_CASE("wrong meshes are refused with file, line and rule") {
  const std::string good = as_stl(box_surface({1, 1, 1}));
  CHECK(refusal_of_mesh("stl", good.substr(0, good.size() - 1)).find("1283 bytes for each") == std::string::npos);
  CHECK(refusal_of_mesh("stl", good.substr(0, good.size() - 1)).find("must be text that begins") != std::string::npos);
  CHECK(refusal_of_mesh("stl", "").find("x.stl: STL: 0 bytes: must be") == 0);
  CHECK(refusal_of_mesh("stl", "solid x\nvertex 0 0\n").find("x.stl: line 2: '': must be three finite numbers") == 0);
  CHECK(refusal_of_mesh("stl", "solid x\nvertex 0 0 0\n").find("1 vertices: must be three a triangle") !=
        std::string::npos);
  CHECK(refusal_of_mesh("stl", "solid x\n").find("has no vertices") != std::string::npos);
  std::string inf = good;
  const float infinite = std::numeric_limits<float>::infinity();
  std::memcpy(inf.data() + 84 + 12, &infinite, 4);
  CHECK(refusal_of_mesh("stl", inf) == "x.stl: triangle 1: must have finite coordinates");
  CHECK(refusal_of_mesh("obj", "v 1 2 x\n") == "x.obj: line 1: 'x': must be three finite numbers");
  CHECK(refusal_of_mesh("obj", "v 1 2 1e999\n").find("must be three finite numbers") != std::string::npos);
  CHECK(refusal_of_mesh("obj", "v 1 2 3\nf 1 1 2\n") ==
        "x.obj: line 2: '2': must be the number of a vertex before it, of 1");
  CHECK(refusal_of_mesh("obj", "v 1 2 3\nf 1 1 -2\n").find("'-2': must be the number") != std::string::npos);
  CHECK(refusal_of_mesh("obj", "v 1 2 3\nf 1 1\n").find("at least three corners") != std::string::npos);
  CHECK(refusal_of_mesh("obj", "o nothing\n") == "x.obj: OBJ: has no vertices: must have some");
  CHECK(models::read_mesh("<dae/>", "x.dae").points.empty());
}
