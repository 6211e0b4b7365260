// Solids that scenes in space are drawn as: convex hulls, surfaces, shapes by contacts, joints and inertias.
#include "experiments/runs/solids.h"
#include "experiments/runs/drawing.h"

#include <doctest/doctest.h>

#include <map>
#include <numbers>
#include <set>

using namespace orthant;

namespace {

/// Volume by the divergence theorem: right only if the faces close and are seen counter-clockwise from outside.
double volume(const Faces& faces) {
  double six = 0;
  for (const auto& face : faces.faces)
    for (std::size_t i = 2; i < face.size(); ++i) {
      const auto at = [&](std::size_t k) { return faces.points[static_cast<std::size_t>(face[k])]; };
      six += at(0).dot(at(i - 1).cross(at(i)));
    }
  return six / 6;
}

/// Each edge is in two faces, once in each direction.
bool closed(const Faces& faces) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& face : faces.faces)
    for (std::size_t i = 0; i < face.size(); ++i) ++edges[{face[i], face[(i + 1) % face.size()]}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
  return true;
}

template <class Kind> std::vector<std::pair<BodyId, Kind>> of_kind(const std::vector<DrawnSolid>& all) {
  std::vector<std::pair<BodyId, Kind>> found;
  for (const DrawnSolid& one : all)
    if (const auto* kind = std::get_if<Kind>(&one.shape)) found.emplace_back(one.body, *kind);
  return found;
}

}  // namespace

TEST_CASE("convex hulls: whole planes as one face, outward, closed; inner and repeated points change nothing") {
  auto corners = spatial::box_corners({1, 2, 3});
  const Faces box = convex_hull(corners);
  CHECK(box.faces.size() == 6);
  for (const auto& face : box.faces) CHECK(face.size() == 4);
  CHECK(closed(box));
  CHECK(volume(box) == doctest::Approx(48).epsilon(1e-14));
  corners.insert(corners.end(),
                 {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(1, 2, 0)});  // inside, on a face, an edge
  const Faces more = convex_hull(corners);
  CHECK(more.faces.size() == 6);
  for (const auto& face : more.faces) CHECK(face.size() == 4);
  CHECK(volume(more) == doctest::Approx(48).epsilon(1e-14));

  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vector3d> icosahedron;
  for (const double a : {-1, 1})
    for (const double b : {-g, g}) icosahedron.insert(icosahedron.end(), {{0, a, b}, {a, b, 0}, {b, 0, a}});
  const Faces solid = convex_hull(icosahedron);
  CHECK(solid.faces.size() == 20);
  CHECK(closed(solid));
  CHECK(volume(solid) == doctest::Approx(20.0 / 12 * (3 + std::sqrt(5.0)) * 2).epsilon(1e-13));

  CHECK(convex_hull({{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 1}}).faces.size() == 1);
  CHECK(convex_hull({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}).faces.empty());
  CHECK(convex_hull({}).faces.empty());
}

TEST_CASE("a hull of many points keeps the extreme ones") {
  std::vector<Vector3d> sphere;
  for (int i = 0; i < 2000; ++i) {
    const double z = 1 - (2 * i + 1) / 2000.0, a = 2.4 * i;
    sphere.emplace_back(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
  }
  const Faces hull = convex_hull(sphere);
  CHECK(hull.points.size() <= 60);
  CHECK(closed(hull));
  CHECK(volume(hull) > 0.85 * 4 / 3 * std::numbers::pi);
}

TEST_CASE("surfaces of spheres and capsules are closed and have their volume, to their facets") {
  const double pi = std::numbers::pi;
  const Faces ball = surface({0, drawn::Sphere{{1, 2, 3}, 2}});
  CHECK(closed(ball));
  CHECK(volume(ball) / (4.0 / 3 * pi * 8) == doctest::Approx(0.93).epsilon(0.03));
  for (const Vector3d& p : ball.points) CHECK(std::abs((p - Vector3d(1, 2, 3)).norm() - 2) < 1e-14);
  const Faces capsule = surface({0, drawn::Capsule{{0, 0, 0}, {3, 4, 0}, 0.5}});
  CHECK(closed(capsule));
  CHECK(volume(capsule) / (pi * 0.25 * 5 + pi / 6) == doctest::Approx(0.96).epsilon(0.03));
}

TEST_CASE("a scene's solids: each shape once, links to joints, boxes of inertia only for bodies without contacts") {
  spatial::Scene s;
  const Vector3d moments(0.2 * 0.2 + 0.4 * 0.4, 0.1 * 0.1 + 0.4 * 0.4, 0.1 * 0.1 + 0.2 * 0.2);  // box of 0.1, 0.2, 0.4
  const auto rod = s.body({.name = "rod", .mass = 12, .inertia = moments.asDiagonal(), .position = {0, 0, 1}});
  const auto ball = s.body({.name = "ball", .position = {0, 0, 0.3}});
  s.joint(spatial::Spherical{"ceiling", kGround, rod, {0, 0, 2}, {0, 0, 1}});
  s.joint(spatial::Revolute{"pin", rod, ball, {0, 0, -0.1}, {0, 0, 0.6}});  // rod's end of it is inside the box
  for (const char* name : {"floor", "again"})
    s.contact(spatial::SpherePlane{name, ball, {0, 0, 0}, 0.3, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = 0.4}});
  const auto all = solids(s);
  const auto spheres = of_kind<drawn::Sphere>(all);
  REQUIRE(spheres.size() == 1);
  CHECK(spheres[0].first == ball);
  CHECK(spheres[0].second.radius == 0.3);
  const auto boxes = of_kind<drawn::Polytope>(all);
  REQUIRE(boxes.size() == 1);
  CHECK(boxes[0].first == rod);
  CHECK(volume(boxes[0].second) == doctest::Approx(0.1 * 0.2 * 0.4).epsilon(1e-12));
  const auto links = of_kind<drawn::Capsule>(all);
  REQUIRE(links.size() == 2);
  CHECK(links[0].second.to == Vector3d(0, 0, 1));
  CHECK(links[1].second.to == Vector3d(0, 0, 0.6));
  const auto planes = of_kind<drawn::Plane>(all);
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].first == kGround);
  CHECK(planes[0].second.half > 1);

  const auto json = drawing(s);
  CHECK(json.at("dimension") == 3);
  CHECK(json.at("solids").size() == all.size());
  CHECK(json.at("joints").at(1).at("axis") == nlohmann::json({0.0, 0.0, 1.0}));
  CHECK(json.at("contacts").at(0).at("mu") == 0.4);
  CHECK(json.at("contacts").at(0).at("radius") == 0.3);
  CHECK(json.at("event_contacts") == nlohmann::json({"floor", "again"}));
}
