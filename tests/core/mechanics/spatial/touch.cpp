// Touch of convex shapes in space: hulls, points, normals and gaps against independent sums.
#include <orthant/core/mechanics/spatial/collision.h>
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

using namespace orthant;

namespace {

using SpatialPose = orthant::spatial::Pose;

Vector3d some_in(Random& random, double size) {
  const double x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}
SpatialPose pose_in(Random& random, double size) {
  const double w = random.uniform(-1, 1), x = random.uniform(-1, 1), y = random.uniform(-1, 1),
               z = random.uniform(-1, 1);
  SpatialPose pose;
  pose.R = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  pose.x = some_in(random, size);
  return pose;
}

spatial::Collision set_of(std::vector<spatial::Shape> shapes) {
  spatial::Collision c{.name = "set", .shapes = std::move(shapes), .law = {}};
  spatial::set_hulls(c);
  return c;
}
spatial::Shape unit_cube(BodyId body) { return {body, spatial::box_corners({0.5, 0.5, 0.5}), 0}; }
spatial::Shape random_polytope(BodyId body, Random& random, int corners) {
  spatial::Shape s{body, {}, 0};
  for (int i = 0; i < corners; ++i) s.corners.push_back(some_in(random, 1));
  return s;
}

std::vector<Vector3d> block_at(const Vector3d& low, const Vector3d& high) {
  std::vector<Vector3d> corners = spatial::box_corners((high - low) / 2);
  for (Vector3d& p : corners) p += (low + high) / 2;
  return corners;
}

double least_gap(const spatial::TouchPoints& points) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < points.count; ++i) least = std::min(least, points.points[static_cast<std::size_t>(i)].gap);
  return least;
}
/// How far two shapes are apart along a direction; < 0: they overlap.
double apart(const Vector3d& n, const SpatialPose& at_a, const spatial::Shape& a, const SpatialPose& at_b,
             const spatial::Shape& b) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (const Vector3d& p : a.corners) high = std::min(high, n.dot(at_a.x + at_a.turn(p)));
  for (const Vector3d& p : b.corners) low = std::max(low, n.dot(at_b.x + at_b.turn(p)));
  return high - low - a.radius - b.radius;
}

}  // namespace

TEST_CASE("a hull has Euler's number of faces and edges, and all points inside") {
  Random random(3);
  for (int points = 4; points <= 24; ++points) {
    CAPTURE(points);
    const spatial::Shape s = random_polytope(0, random, points);
    const spatial::Hull hull = spatial::hull_of(s.corners);
    CHECK(hull.corners.size() + hull.faces.size() == hull.edges.size() + 2);
    for (const Vector3d& p : s.corners) CHECK(hull.depth_of(p) < 1e-12);
    for (const spatial::Hull::Face& face : hull.faces) {
      Vector3d normal(0, 0, 0);  // Newell's sum over the rim, counter-clockwise
      for (std::size_t i = 0; i < face.corners.size(); ++i)
        normal += hull.corners[static_cast<std::size_t>(face.corners[i])].cross(
            hull.corners[static_cast<std::size_t>(face.corners[(i + 1) % face.corners.size()])]);
      CHECK((normal.normalized() - face.normal).norm() < 1e-9);
    }
  }
  const spatial::Hull cube = spatial::hull_of(spatial::box_corners({1, 2, 3}));
  CHECK(cube.faces.size() == 6);
  CHECK(cube.edges.size() == 12);
  for (const spatial::Hull::Face& face : cube.faces) CHECK(face.corners.size() == 4);
}

TEST_CASE("hulls of too few, too many and flat points are refused") {
  const std::vector<Vector3d> flat = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}};
  CHECK_THROWS_WITH_AS(static_cast<void>(spatial::hull_of(flat)), "must not lie in one plane", std::invalid_argument);
  CHECK_THROWS_WITH_AS(static_cast<void>(spatial::hull_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})),
                       "must be 4 to 64 points, are 3", std::invalid_argument);
  for (const double size : {1e300, 1e100, 1e-100, 1e-300})
    CHECK_THROWS_WITH_AS(static_cast<void>(spatial::hull_of(spatial::box_corners({size, size, size}))),
                         "must span 1e-60 to 1e60 m, and lie within 1e60 m of the origin", std::invalid_argument);
  for (const double size : {1e60, 1e-59})
    CHECK(spatial::hull_of(spatial::box_corners({size, size, size})).faces.size() == 6);
  CHECK_THROWS_AS(static_cast<void>(spatial::hull_of(std::vector<Vector3d>(65, Vector3d(1, 2, 3)))),
                  std::invalid_argument);
  CHECK_THROWS_AS(static_cast<void>(spatial::hull_of(std::vector<Vector3d>(5, Vector3d(1, 2, 3)))),
                  std::invalid_argument);
}

TEST_CASE("two polytopes overlap exactly where a gap is negative, and no direction parts them more") {
  Random random(1);
  int overlaps = 0;
  for (int i = 0; i < 3000; ++i) {
    const bool cubes = i % 2 == 0;
    const spatial::Collision c = set_of(
        {cubes ? unit_cube(0) : random_polytope(0, random, 8), cubes ? unit_cube(1) : random_polytope(1, random, 12)});
    const SpatialPose at_a = pose_in(random, 0.6), at_b = pose_in(random, 0.6);
    const spatial::TouchPoints points = touch(at_a, c.shapes[0], at_b, c.shapes[1]);
    REQUIRE(points.count > 0);
    const double along = apart(points.points[0].n, at_a, c.shapes[0], at_b, c.shapes[1]), gap = least_gap(points);
    for (int k = 0; k < points.count; ++k) {
      const spatial::TouchPoint& p = points.points[static_cast<std::size_t>(k)];
      CHECK(std::abs(p.n.norm() - 1) < 1e-12);
      CHECK((p.on_a - p.on_b - p.gap * p.n).norm() < 1e-9);
    }
    double most = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < 200; ++k) {
      const Vector3d n = some_in(random, 1).normalized();
      most = std::max(most, apart(n, at_a, c.shapes[0], at_b, c.shapes[1]));
    }
    if (most > 1e-9) CHECK(gap > 0);
    if (gap < 0) {
      ++overlaps;
      CHECK(std::abs(gap - along) < 1e-9);
      CHECK(most < gap + 2e-5);
    }
    const spatial::TouchPoints other = touch(at_b, c.shapes[1], at_a, c.shapes[0]);
    CHECK(std::abs(least_gap(other) - gap) < 1e-5);
  }
  CHECK(overlaps > 500);
}

TEST_CASE("a cube flush on a cube touches in the corners of the overlap, turned by any angle") {
  const spatial::Collision c = set_of({unit_cube(0), unit_cube(1)});
  SpatialPose ground, top;
  top.x = {0.2, 0.3, 1};
  for (const double angle : {0.0, 1e-9, 0.3, 0.785398163397448}) {
    CAPTURE(angle);
    top.R = Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
    const spatial::TouchPoints points = touch(ground, c.shapes[0], top, c.shapes[1]);
    CHECK(points.count == 4);
    for (int i = 0; i < points.count; ++i) {
      const spatial::TouchPoint& p = points.points[static_cast<std::size_t>(i)];
      CHECK(p.n.z() == doctest::Approx(-1));
      CHECK(std::abs(p.gap) < 1e-15);
      CHECK(p.on_a.head<2>().lpNorm<Eigen::Infinity>() < 0.5 + 1e-12);
    }
  }
}

TEST_CASE("a cube that overhangs touches over the face below it only, however little it tilts") {
  const spatial::Collision c = set_of({unit_cube(0), unit_cube(1)});
  SpatialPose ground, top;
  top.x = {0.6, 0.1, 1};
  for (const double tilt : {0.0, 1e-12, 1e-9, 1e-7, 1e-5}) {
    CAPTURE(tilt);
    top.R = Eigen::AngleAxisd(tilt, Vector3d::UnitY()).toRotationMatrix();
    const spatial::TouchPoints points = touch(ground, c.shapes[0], top, c.shapes[1]);
    CHECK(points.count == 4);
    for (int i = 0; i < points.count; ++i)
      CHECK(points.points[static_cast<std::size_t>(i)].on_a.head<2>().lpNorm<Eigen::Infinity>() < 0.5 + 1e-8);
  }
}

TEST_CASE("points of two polytopes keep their numbers while rounding chooses the deepest") {
  const spatial::Collision c = set_of({unit_cube(0), unit_cube(1)});
  Random random(3);
  SpatialPose ground, top;
  top.x = {0.2, 0.3, 1};
  const spatial::TouchPoints first = touch(ground, c.shapes[0], top, c.shapes[1]);
  for (int round = 0; round < 50; ++round) {
    top.R = quaternions::matrix_of(quaternions::exponential(1e-9 * some_in(random, 1)).normalized());
    const spatial::TouchPoints points = touch(ground, c.shapes[0], top, c.shapes[1]);
    REQUIRE(points.count == 4);
    for (std::size_t i = 0; i < 4; ++i) CHECK((points.points[i].on_a - first.points[i].on_a).norm() < 1e-8);
  }
}

TEST_CASE("spheres and capsules: the nearest points of their cores; at the ends of an overlap too") {
  const spatial::Collision c = set_of({{0, {{-1, 0, 0}, {1, 0, 0}}, 0.2}, {1, {{0, 0, 0}}, 0.3}, unit_cube(2)});
  const auto &capsule = c.shapes[0], &ball = c.shapes[1], &cube = c.shapes[2];
  SpatialPose here, there;
  there.x = {0.3, 0, 0.6};
  CHECK(std::abs(least_gap(touch(here, capsule, there, ball)) - 0.1) < 1e-15);
  there.x = {0.5, 0, 0.4};
  const spatial::TouchPoints beside = touch(here, capsule, there, capsule);
  REQUIRE(beside.count >= 2);
  CHECK((beside.points[0].on_a - beside.points[1].on_a).norm() == doctest::Approx(1.5));
  CHECK(std::abs(beside.points[1].gap) < 1e-15);
  there.x = {0, 0, 0.7};
  const spatial::TouchPoints across =
      touch(there, capsule, here, cube);  // longer than the cube: where it crosses its edges
  int edges = 0;
  for (int i = 0; i < across.count; ++i) {
    const spatial::TouchPoint& p = across.points[static_cast<std::size_t>(i)];
    if (!(std::abs(p.gap) < 1e-15)) continue;  // the capsule's ends
    ++edges;
    CHECK(std::abs(p.on_b.x()) == doctest::Approx(0.5));
    CHECK(p.n.z() == doctest::Approx(1));
  }
  CHECK(edges == 2);
  there.x = {0.6, 0.6, 0.6};
  const double corner = std::sqrt(0.03) - 0.3;
  CHECK(std::abs(least_gap(touch(there, ball, here, cube)) - corner) < 1e-15);
  CHECK(std::abs(least_gap(touch(here, cube, there, ball)) - corner) < 1e-15);
  there.x = {0.1, 0.2, 0.45};  // the centre inside: out by the nearest face
  const spatial::TouchPoints inside = touch(there, ball, here, cube);
  CHECK(std::abs(least_gap(inside) + 0.35) < 1e-15);
  CHECK(inside.points[0].n.z() == doctest::Approx(1));
}

TEST_CASE("faces between two tiles of one body take no part") {
  spatial::Shape left = unit_cube(kGround), right = unit_cube(kGround);
  for (Vector3d& p : left.corners) p.x() -= 0.5;
  for (Vector3d& p : right.corners) p.x() += 0.5;
  const spatial::Collision c = set_of({left, right, unit_cube(0), {1, {{0, 0, 0}}, 0.2}});
  CHECK(std::count_if(c.shapes[1].hull->faces.begin(), c.shapes[1].hull->faces.end(),
                      [](const spatial::Hull::Face& face) { return face.covered; }) == 1);
  SpatialPose ground, box;
  for (const double x : {-0.5 + 1e-12, -0.5, -0.5 + 1e-3}) {  // its leading face is at the seam
    CAPTURE(x);
    box.x = {x, 0, 1 - 1e-6};
    const spatial::TouchPoints points = touch(box, c.shapes[2], ground, c.shapes[1]);
    for (int i = 0; i < points.count; ++i) CHECK(points.points[static_cast<std::size_t>(i)].n.z() > 0.999);
    box.x = {x + 0.5, 0, 0.7 - 1e-6};
    const spatial::TouchPoints ball = touch(box, c.shapes[3], ground, c.shapes[1]);
    if (ball.count > 0) CHECK(ball.points[0].n.z() > 0.999);
  }
}

TEST_CASE("a tilted box on one tile has no contact with the next one before it is there") {
  // The seam is 4 mm ahead of the lowest corner; the free corners of the next tile are 2 m aside.
  spatial::Collision c{.name = "tiles", .shapes = {{0, spatial::box_corners({0.2, 0.15, 0.1}), 0}}, .law = {}};
  for (const double x : {0.0, 0.1}) c.shapes.push_back({kGround, block_at({x, -2, -1}, {x + 0.1, 2, 0}), 0});
  spatial::set_hulls(c);
  SpatialPose box, ground;
  box.R = Eigen::Quaterniond(0.9961289715540884, -0.0023736125315894545, 0.08786367875954158, 0.0011882545957114896)
              .normalized()
              .toRotationMatrix();
  for (const double ahead : {0.0, 5e-5, 1e-3, 3e-3}) {
    CAPTURE(ahead);
    box.x = {-0.0834003 + ahead, 0.11666, 0.1339383};
    CHECK(least_gap(touch(box, c.shapes[0], ground, c.shapes[1])) < 0);
    CHECK(least_gap(touch(box, c.shapes[0], ground, c.shapes[2])) > 1e-4);
  }
}

TEST_CASE("a large face behind two small ones takes no part: a brick bond acts as one surface") {
  spatial::Collision c{.name = "bond", .shapes = {{0, spatial::box_corners({0.2, 0.15, 0.1}), 0}}, .law = {}};
  c.shapes.push_back({kGround, block_at({0, -1, -1}, {1, 1, 0}), 0});
  c.shapes.push_back({kGround, block_at({-1, -1, -1}, {0, 0.3, 0}), 0});
  c.shapes.push_back({kGround, block_at({-1, 0.3, -1}, {0, 1, 0}), 0});
  spatial::set_hulls(c);
  SpatialPose box, ground;
  for (const double over : {1e-12, 1e-7, 1e-4, 0.01}) {  // [m] past the seam, at a depth of 1e-5
    CAPTURE(over);
    box.x = {-0.2 + over, 0.2, 0.1 - 1e-5};
    for (std::size_t i = 1; i < c.shapes.size(); ++i) {
      const spatial::TouchPoints points = touch(box, c.shapes[0], ground, c.shapes[i]);
      for (int k = 0; k < points.count; ++k)
        if (points.at(k).gap < 0) CHECK(points.at(k).n.z() > 0.999);
    }
  }
}

TEST_CASE("polytopes apart and beside each other's faces are as far apart as their nearest points") {
  spatial::Collision c{.name = "pair", .shapes = {{0, spatial::box_corners({0.5, 0.5, 0.5}), 0}}, .law = {}};
  c.shapes.push_back({1, spatial::box_corners({0.5, 0.5, 0.5}), 0});
  spatial::set_hulls(c);
  SpatialPose one, other;
  other.x = {1.03, 1.04, 0};  // edge beside edge
  CHECK(std::abs(touch(one, c.shapes[0], other, c.shapes[1]).at(0).gap - 0.05) < 1e-15);
  other.x = {1.01, 1.02, 1.02};  // corner beside corner
  const spatial::TouchPoints points = touch(one, c.shapes[0], other, c.shapes[1]);
  CHECK(points.count == 1);
  CHECK(std::abs(points.at(0).gap - 0.03) < 1e-15);
  CHECK((points.at(0).on_a - Vector3d(0.5, 0.5, 0.5)).norm() < 1e-15);
}

TEST_CASE("volumes and inertias of solids, against sums over points") {
  Random random(5);
  struct Case {
    spatial::Solid solid;
    Vector3d half;
    bool (*inside)(const Vector3d&);
  };
  const Case cases[] = {
      {spatial::box({1, 2, 0.6}), {0.5, 1, 0.3}, [](const Vector3d&) { return true; }},
      {spatial::ellipsoid({0.5, 1, 0.3}),
       {0.5, 1, 0.3},
       [](const Vector3d& p) { return p.cwiseQuotient(Vector3d(0.5, 1, 0.3)).norm() < 1; }},
      {spatial::cylinder(0.5, 1.4), {0.5, 0.5, 0.7}, [](const Vector3d& p) { return p.head<2>().norm() < 0.5; }},
      {spatial::capsule(0.4, 1),
       {0.4, 0.4, 0.9},
       [](const Vector3d& p) { return (p - Vector3d(0, 0, std::clamp(p.z(), -0.5, 0.5))).norm() < 0.4; }},
      {spatial::cone(0.5, 1.2), {0.5, 0.5, 0.9}, [](const Vector3d& p) {
         return p.z() > -0.3 && p.head<2>().norm() < 0.5 * (0.9 - p.z()) / 1.2;
       }}};
  for (const Case& one : cases) {
    constexpr int kPoints = 400000;
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    int hits = 0;
    for (int i = 0; i < kPoints; ++i) {
      const Vector3d p = some_in(random, 1).cwiseProduct(one.half);
      if (!one.inside(p)) continue;
      ++hits, sum += p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose();
    }
    CHECK(one.solid.volume == doctest::Approx(8 * one.half.prod() * hits / kPoints).epsilon(0.01));
    CHECK((sum / hits - one.solid.inertia).norm() < 0.01 * one.solid.inertia.norm());
  }
}
