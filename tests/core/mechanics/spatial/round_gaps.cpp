// Signed distance of spheres and capsules in space: gaps, normals and points of contact against independent sums.
#include <orthant/core/mechanics/spatial/height_field.h>
#include "tests/support/round_shapes.h"

#include <doctest/doctest.h>

#include <array>

using namespace orthant;

namespace {

/// Spheres and capsules, and all kinds of shapes that these meet.
std::vector<spatial::Shape> partners(Random& random, int round) {
  std::vector<spatial::Shape> all = {
      {1, {{0, 0, 0}}, 0.2}, capsule_along_x(1, 0.15), capsule_along_x(1, random.uniform(0.02, 0.6), 0.05)};
  const Vector3d half = Vector3d(0.16, 0.16, 0.16) + anywhere_in(random, 0.12);
  all.push_back(box_between(1, -half, half));
  spatial::Shape polytope{1, {}, 0};
  for (int i = 0; i < 4 + round % 7; ++i) polytope.corners.push_back(0.28 * anywhere_in(random, 1).normalized());
  all.push_back(polytope);
  spatial::HeightField field{.origin = {-0.2, -0.2, 0}, .dx = 0.4, .dy = 0.3, .heights = Eigen::MatrixXd::Zero(2, 2)};
  field.heights(0) = random.uniform(-0.3, 0.3), field.heights(3) = random.uniform(-0.3, 0.3), field.depth = 0.2;
  all.push_back(spatial::shapes_of(field, 1).front());
  return all;
}

/// Both orders of the shapes against the true gap; each point against its shapes.
void judge_touch(const PlacedShape& round, const PlacedShape& other, double gap) {
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
    CHECK(outside_of_shape(round, p.on_a) < 1e-9);
    CHECK(outside_of_shape(other, p.on_b) < 1e-9);
    const bool cores_meet = !other.shape.polytope() && gap + round.shape.radius + other.shape.radius < 1e-6;
    if (p.gap < gap + 1e-12 && !cores_meet)  // its normal parts the shapes
      CHECK(std::abs(reach_along(round, -p.n) + reach_along(other, p.n) + gap) < 1e-7);
  }
}

}  // namespace

TEST_CASE("spheres and capsules have the gap of their signed distance to any shape, in both orders") {
  Random random(37);
  int overlaps = 0, deep = 0;
  for (int round = 0; round < 200; ++round) {
    const double half = round % 2 == 0 ? 0.15 : random.uniform(0.02, 0.8);
    const spatial::Collision c = [&] {
      std::vector<spatial::Shape> shapes = {{0, {{0, 0, 0}}, kRodRadius}, capsule_along_x(0, half)};
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
        const PlacedShape other{c.shapes[i], at};
        const double wanted = random.uniform() < 0.3 ? random.uniform(-0.3, -0.12) : random.uniform(-0.1, 0.05);
        const PlacedShape one{c.shapes[k], pose_at_gap(random, c.shapes[k], other, wanted)};
        const double gap = true_gap(one, other);
        overlaps += gap < 0, deep += gap < -kRodRadius;
        judge_touch(one, other, gap);
      }
  }
  CHECK(overlaps > 1000);
  CHECK(deep > 150);
}

TEST_CASE("gaps of capsules change by no more than the shapes move") {
  Random random(5);
  for (int round = 0; round < 60; ++round) {
    const spatial::Collision c = [&] {
      std::vector<spatial::Shape> shapes = {capsule_along_x(0, random.uniform(0.05, 0.5))};
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
      constexpr double kSmallTurn = 2;
      double before = kNowhere;
      for (int step = 0; step <= kSteps; ++step) {
        const double t = static_cast<double>(step) / kSteps;
        spatial::Pose pose, here;
        pose.x = from + t * (to - from), pose.R = Eigen::AngleAxisd(kSmallTurn * t, axis).toRotationMatrix() * start;
        const double gap = smallest_gap(touch(pose, c.shapes[0], here, c.shapes[i]));
        CAPTURE(round);
        CAPTURE(i);
        CAPTURE(step);
        if (step > 0) CHECK(std::abs(gap - before) < ((to - from).norm() + kSmallTurn * half) / kSteps + 1e-9);
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
    const spatial::Collision c = hulled({capsule_along_x(0, one.length / 2), box_between(1, -half, half)});
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
  const spatial::Collision c = hulled({capsule_along_x(0, 0.5), capsule_along_x(1, 0.5), capsule_along_x(2, 0.2)});
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
