// Signed distance of spheres and capsules in space: gaps, normals and points of contact against independent sums.
#include <orthant/core/mechanics/spatial/collision.h>
#include <orthant/core/mechanics/spatial/height_field.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

using namespace orthant;

namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr double kRodRadius = 0.12;  // [m]

Vector3d anywhere_in(Random& random, double size) {
  const double x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}
Eigen::Matrix3d any_turn(Random& random) {
  const double w = random.uniform(-1, 1), x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return Eigen::Quaterniond(w, x, y, random.uniform(-1, 1)).normalized().toRotationMatrix();
}
spatial::Shape rod(BodyId body, double half, double radius = kRodRadius) {
  return {body, {{-half, 0, 0}, {half, 0, 0}}, radius};
}
spatial::Shape block(BodyId body, const Vector3d& low, const Vector3d& high) {
  spatial::Shape s{body, spatial::box_corners((high - low) / 2), 0};
  for (Vector3d& p : s.corners) p += (low + high) / 2;
  return s;
}
spatial::Collision hulled(std::vector<spatial::Shape> shapes) {
  spatial::Collision c{.name = "set", .shapes = std::move(shapes), .law = {}};
  spatial::set_hulls(c);
  return c;
}

double smallest_gap(const spatial::TouchPoints& points) {
  double least = kNowhere;
  for (int i = 0; i < points.count; ++i) least = std::min(least, points.at(i).gap);
  return least;
}

/// Least value of a convex function on [0, 1].
template <class Function> double least_of(Function&& f) {
  double low = 0, high = 1, best = std::min(f(0.0), f(1.0));
  for (int i = 0; i < 90; ++i) {
    const double x = low + (high - low) / 3, y = high - (high - low) / 3, at_x = f(x), at_y = f(y);
    best = std::min({best, at_x, at_y});
    (at_x <= at_y ? high : low) = at_x <= at_y ? y : x;
  }
  return best;
}
double to_segment(const Vector3d& x, const Vector3d& p, const Vector3d& q) {
  const double square = (q - p).squaredNorm();
  const double s = square > 0 ? std::clamp((x - p).dot(q - p) / square, 0.0, 1.0) : 0;
  return (x - p - s * (q - p)).norm();
}
/// 0 inside.
double to_hull(const Vector3d& x, const spatial::Hull& hull) {
  if (hull.depth_of(x) <= 0) return 0;
  double least = kNowhere;
  for (const spatial::Hull::Face& face : hull.faces) {
    const double height = face.normal.dot(x) - face.offset;
    bool within = height > 0;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const Vector3d &p = hull.corners[static_cast<std::size_t>(face.corners[i])],
                     &q = hull.corners[static_cast<std::size_t>(face.corners[(i + 1) % face.corners.size()])];
      least = std::min(least, to_segment(x, p, q));
      within = within && face.normal.dot((q - p).cross(x - p)) >= 0;
    }
    if (within) least = std::min(least, height);
  }
  return least;
}

/// A core, from p to q, and a polytope: their distance, or < 0 the shortest translation that parts them.
double signed_distance(const Vector3d& p, const Vector3d& q, const spatial::Hull& hull) {
  const double away = least_of([&](double s) { return to_hull(p + s * (q - p), hull); });
  if (away > 0) return away;
  double most = -kNowhere;
  const auto look = [&](const Vector3d& n) {
    double high = -kNowhere;
    for (const Vector3d& corner : hull.corners) high = std::max(high, n.dot(corner));
    most = std::max(most, std::min(n.dot(p), n.dot(q)) - high);
  };
  for (const spatial::Hull::Face& face : hull.faces) look(face.normal);
  for (const spatial::Hull::Edge& e : hull.edges) {
    const Vector3d n =
        (q - p).cross(hull.corners[static_cast<std::size_t>(e.to)] - hull.corners[static_cast<std::size_t>(e.from)]);
    if (n.norm() < 1e-12) continue;
    look(n.normalized()), look(-n.normalized());
  }
  return most;
}

struct Placed {
  const spatial::Shape& shape;
  spatial::Pose pose;
  Vector3d end(bool last) const { return pose.x + pose.turn(last ? shape.corners.back() : shape.corners.front()); }
};
/// The gap of a sphere or capsule to another shape.
double true_gap(const Placed& round, const Placed& other) {
  const Vector3d p = round.end(false), q = round.end(true);
  if (other.shape.polytope()) {
    const auto in = [&](const Vector3d& x) { return Vector3d(other.pose.turn_back(x - other.pose.x)); };
    return signed_distance(in(p), in(q), *other.shape.hull) - round.shape.radius;
  }
  const Vector3d u = other.end(false), v = other.end(true);
  return least_of([&](double s) { return to_segment(p + s * (q - p), u, v); }) - round.shape.radius -
         other.shape.radius;
}

/// How far a shape reaches along a direction.
double reach(const Placed& one, const Vector3d& n) {
  double most = -kNowhere;
  for (const Vector3d& p : one.shape.corners) most = std::max(most, n.dot(one.pose.x + one.pose.turn(p)));
  return most + one.shape.radius;
}
/// How far a point is outside of a shape.
double outside_of(const Placed& one, const Vector3d& x) {
  if (one.shape.polytope()) return to_hull(one.pose.turn_back(x - one.pose.x), *one.shape.hull);
  return std::max(0.0, to_segment(x, one.end(false), one.end(true)) - one.shape.radius);
}

/// Spheres and capsules, and all kinds of shapes that these meet.
std::vector<spatial::Shape> partners(Random& random, int round) {
  std::vector<spatial::Shape> all = {{1, {{0, 0, 0}}, 0.2}, rod(1, 0.15), rod(1, random.uniform(0.02, 0.6), 0.05)};
  const Vector3d half = Vector3d(0.16, 0.16, 0.16) + anywhere_in(random, 0.12);
  all.push_back(block(1, -half, half));
  spatial::Shape polytope{1, {}, 0};
  for (int i = 0; i < 4 + round % 7; ++i) polytope.corners.push_back(0.28 * anywhere_in(random, 1).normalized());
  all.push_back(polytope);
  spatial::HeightField field{.origin = {-0.2, -0.2, 0}, .dx = 0.4, .dy = 0.3, .heights = Eigen::MatrixXd::Zero(2, 2)};
  field.heights(0) = random.uniform(-0.3, 0.3), field.heights(3) = random.uniform(-0.3, 0.3), field.depth = 0.2;
  all.push_back(spatial::shapes_of(field, 1).front());
  return all;
}

/// Both orders of the shapes against the true gap; each point against its shapes.
void judge(const Placed& round, const Placed& other, double gap) {
  const spatial::TouchPoints points = touch(round.pose, round.shape, other.pose, other.shape);
  const spatial::TouchPoints turned = touch(other.pose, other.shape, round.pose, round.shape);
  REQUIRE(points.count > 0);
  CHECK(std::abs(smallest_gap(points) - gap) < 1e-9);
  CHECK(std::abs(smallest_gap(turned) - gap) < 1e-9);
  CHECK(points.count <= spatial::most_points(round.shape, other.shape));
  CHECK(turned.count <= spatial::most_points(other.shape, round.shape));
  for (int i = 0; i < points.count; ++i) {
    const spatial::TouchPoint p = points.at(i);
    CHECK(std::abs(p.n.norm() - 1) < 1e-12);
    CHECK((p.on_a - p.on_b - p.gap * p.n).norm() < 1e-9);
    CHECK(outside_of(round, p.on_a) < 1e-9);
    CHECK(outside_of(other, p.on_b) < 1e-9);
    const bool cores_meet = !other.shape.polytope() && gap + round.shape.radius + other.shape.radius < 1e-6;
    if (p.gap < gap + 1e-12 && !cores_meet)  // its normal parts the shapes
      CHECK(std::abs(reach(round, -p.n) + reach(other, p.n) + gap) < 1e-7);
  }
}

/// A pose whose gap to the other shape is about `gap`, along a random direction.
spatial::Pose pose_at_gap(Random& random, const spatial::Shape& round, const Placed& other, double gap) {
  spatial::Pose pose;
  pose.R = any_turn(random);
  const Vector3d start = other.pose.x + anywhere_in(random, 0.1), way = anywhere_in(random, 1).normalized();
  double low = 0, high = 2;
  for (int i = 0; i < 25; ++i) {
    pose.x = start + (low + high) / 2 * way;
    (true_gap({round, pose}, other) > gap ? high : low) = (low + high) / 2;
  }
  return pose;
}

/// Whether an end of a capsule is beside the ground of over_ground().
bool borders(const spatial::Shape& shape, const spatial::Pose& pose) {
  return std::any_of(shape.corners.begin(), shape.corners.end(), [&](const Vector3d& end) {
    const Vector3d x = pose.x + pose.turn(end);
    return std::max(std::abs(x.x()), std::abs(x.y())) > 1;
  });
}

/// Terrain or flat tiles, and a capsule.
spatial::Collision over_ground(const Eigen::MatrixXd& heights, const spatial::Shape& over) {
  spatial::Collision c{.name = "ground", .shapes = {over}, .law = {}};
  const spatial::HeightField field{.origin = {-1, -1, 0}, .dx = 0.5, .dy = 0.5, .heights = heights, .depth = 1};
  for (const spatial::Shape& prism : spatial::shapes_of(field, kGround)) c.shapes.push_back(prism);
  spatial::set_hulls(c);
  return c;
}

}  // namespace

TEST_CASE("spheres and capsules have the gap of their signed distance to any shape, in both orders") {
  Random random(37);
  int overlaps = 0, deep = 0;
  for (int round = 0; round < 400; ++round) {
    const double half = round % 2 == 0 ? 0.15 : random.uniform(0.02, 0.8);
    const spatial::Collision c = [&] {
      std::vector<spatial::Shape> shapes = {{0, {{0, 0, 0}}, kRodRadius}, rod(0, half)};
      for (const spatial::Shape& s : partners(random, round)) shapes.push_back(s);
      for (std::size_t i = 2; i < shapes.size(); ++i) shapes[i].body = static_cast<BodyId>(i);  // none is covered
      return hulled(shapes);
    }();
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t i = 2; i < c.shapes.size(); ++i) {
        CAPTURE(round);
        CAPTURE(k);
        CAPTURE(i);
        spatial::Pose at;
        at.R = any_turn(random), at.x = anywhere_in(random, 1);
        const Placed other{c.shapes[i], at};
        const double wanted = random.uniform() < 0.3 ? random.uniform(-0.3, -0.12) : random.uniform(-0.1, 0.05);
        const Placed one{c.shapes[k], pose_at_gap(random, c.shapes[k], other, wanted)};
        const double gap = true_gap(one, other);
        overlaps += gap < 0, deep += gap < -kRodRadius;
        judge(one, other, gap);
      }
  }
  CHECK(overlaps > 2000);
  CHECK(deep > 300);
}

TEST_CASE("gaps of capsules change by no more than the shapes move") {
  Random random(5);
  for (int round = 0; round < 60; ++round) {
    const spatial::Collision c = [&] {
      std::vector<spatial::Shape> shapes = {rod(0, random.uniform(0.05, 0.5))};
      for (const spatial::Shape& s : partners(random, round)) shapes.push_back(s);
      for (std::size_t i = 1; i < shapes.size(); ++i) shapes[i].body = static_cast<BodyId>(i);
      return hulled(shapes);
    }();
    const double half = c.shapes[0].corners.back().x();
    for (std::size_t i = 1; i < c.shapes.size(); ++i) {
      const Vector3d from = 0.5 * anywhere_in(random, 1).normalized(), to = anywhere_in(random, 0.2) - 0.4 * from,
                     axis = anywhere_in(random, 1).normalized();
      const Eigen::Matrix3d start = any_turn(random);
      constexpr int kSteps = 500;
      constexpr double kTurn = 2;
      double before = kNowhere;
      for (int step = 0; step <= kSteps; ++step) {
        const double t = static_cast<double>(step) / kSteps;
        spatial::Pose pose, here;
        pose.x = from + t * (to - from), pose.R = Eigen::AngleAxisd(kTurn * t, axis).toRotationMatrix() * start;
        const double gap = smallest_gap(touch(pose, c.shapes[0], here, c.shapes[i]));
        CAPTURE(round);
        CAPTURE(i);
        CAPTURE(step);
        if (step > 0) CHECK(std::abs(gap - before) < ((to - from).norm() + kTurn * half) / kSteps + 1e-9);
        before = gap;
      }
    }
  }
}

TEST_CASE("a capsule on a corner, an edge or a face has as many points as carry it, under the same numbers") {
  const Vector3d half(0.5, 0.5, 0.5);
  struct Case {
    double length;
    Vector3d along, at;  // of the capsule, where it touches the cube
    int points;
  };
  const Vector3d x(1, 0, 0), bevel(0, 1, 1), skew = Vector3d(1, -1, 0).normalized();
  const double side = kRodRadius / std::sqrt(2), corner = kRodRadius / std::sqrt(3);
  const Case cases[] = {{0.6, x, {0.1, 0, 0.5 + kRodRadius}, 2},     // ends on a face
                        {2, x, {0.1, 0, 0.5 + kRodRadius}, 2},       // across a face
                        {2, skew, {0.1, 0.2, 0.5 + kRodRadius}, 2},  // obliquely
                        {0.8, x, {0.3, 0, 0.5 + kRodRadius}, 2},     // an end on a face, an edge
                        {0.6, x, {0.1, 0.5 + side, 0.5 + side}, 2},  // along an edge
                        {2, x, {0.1, 0.5 + side, 0.5 + side}, 2},    // along all of an edge
                        {1, bevel.cross(x).normalized(), {0.1, 0.5 + side, 0.5 + side}, 1},  // across an edge
                        {1, skew, (0.5 + corner) * Vector3d(1, 1, 1), 1}};                   // at a corner
  Random random(3);
  for (const Case& one : cases) {
    CAPTURE(one.at);
    CAPTURE(one.length);
    const spatial::Collision c = hulled({rod(0, one.length / 2), block(1, -half, half)});
    spatial::Pose pose, here;
    const Eigen::Matrix3d R = Eigen::Quaterniond::FromTwoVectors(Vector3d(1, 0, 0), one.along).toRotationMatrix();
    std::array<Vector3d, 4> first;
    for (int k = 0; k < 50; ++k) {
      const double tilt = k < 2 ? 0 : k < 25 ? 1e-9 : 1e-5;
      pose.R = Eigen::AngleAxisd(tilt, anywhere_in(random, 1).normalized()).toRotationMatrix() * R;
      pose.x = one.at + tilt * anywhere_in(random, 1);
      for (const bool turned : {false, true}) {
        const spatial::TouchPoints points =
            turned ? touch(here, c.shapes[1], pose, c.shapes[0]) : touch(pose, c.shapes[0], here, c.shapes[1]);
        int touching = 0;
        for (int i = 0; i < points.count; ++i) {
          const spatial::TouchPoint p = points.at(i);
          if (std::abs(p.gap) > 1e-4) continue;
          ++touching;
          if (k == 0 && !turned) first[static_cast<std::size_t>(i)] = p.on_b;
          const Vector3d& place = turned ? p.on_a : p.on_b;
          if (!turned) CHECK((place - first[static_cast<std::size_t>(i)]).norm() < 100 * tilt + 1e-12);
        }
        CHECK(touching == one.points);
      }
    }
  }
}

TEST_CASE("two capsules that lie along each other touch at both ends of their overlap, however they are turned") {
  const spatial::Collision c = hulled({rod(0, 0.5), rod(1, 0.5), rod(2, 0.2)});
  for (const double yaw : {0.0, 1e-12, 1e-7, 1e-5, 1e-4, -1e-4, 1e-3, 0.03})
    for (const std::size_t other : {1U, 2U}) {
      CAPTURE(yaw);
      CAPTURE(other);
      spatial::Pose low, high;
      high.x = {0, 0, 2 * kRodRadius - 1e-6};
      high.R = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
      for (const bool turned : {false, true}) {
        const spatial::TouchPoints points =
            turned ? touch(high, c.shapes[other], low, c.shapes[0]) : touch(low, c.shapes[0], high, c.shapes[other]);
        double least = kNowhere, most = -kNowhere;
        REQUIRE(points.count <= 3);
        for (int i = 0; i < points.count; ++i) {
          const double x = points.at(i).on_a.x();
          least = std::min(least, x), most = std::max(most, x);
        }
        CHECK(most - least > (other == 1 ? 1 : 0.4) - 1e-3);
      }
    }
}

TEST_CASE("a capsule over terrain is as far from it as from the nearest prism, over flat tiles without a ghost") {
  Random random(11);
  int near = 0;
  for (int k = 0; k < 60; ++k) {
    Eigen::MatrixXd heights = Eigen::MatrixXd::Zero(5, 5);
    if (k % 3 != 0)
      for (Eigen::Index i = 0; i < heights.size(); ++i)
        heights(i) = k % 3 == 1 ? random.uniform(-0.4, 0.4) : random.integer(0, 2) * 0.2;
    const spatial::Collision c = over_ground(heights, rod(0, random.uniform(0.05, 0.8)));
    for (int p = 0; p < 60; ++p) {
      spatial::Pose pose, here;
      const double tilt = p % 3 == 0 ? 0 : p % 3 == 1 ? random.uniform(-0.05, 0.05) : random.uniform(-1.5, 1.5);
      pose.R = (Eigen::AngleAxisd(p % 5 == 0 ? 0 : random.uniform(-3, 3), Vector3d::UnitZ()) *
                Eigen::AngleAxisd(tilt, Vector3d::UnitY()))
                   .toRotationMatrix();
      pose.x = Vector3d(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), random.uniform(0, 0.6));
      double alone = kNowhere, together = kNowhere;
      for (std::size_t i = 1; i < c.shapes.size(); ++i) {
        alone = std::min(alone, true_gap({c.shapes[0], pose}, {c.shapes[i], here}));
        const spatial::TouchPoints points = touch(pose, c.shapes[0], here, c.shapes[i]);
        together = std::min(together, smallest_gap(points));
      }
      if (alone < -kRodRadius + 1e-9) continue;  // its core is in the ground
      ++near;
      CAPTURE(k);
      CAPTURE(p);
      CHECK(std::abs(together - alone) < 1e-9);
      if (k % 3 != 0 || borders(c.shapes[0], pose)) continue;
      for (std::size_t i = 1; i < c.shapes.size(); ++i) {
        const spatial::TouchPoints points = touch(pose, c.shapes[0], here, c.shapes[i]);
        for (int q = 0; q < points.count; ++q) CHECK(points.at(q).n.z() > 0.999);
      }
    }
  }
  CHECK(near > 1000);
}
