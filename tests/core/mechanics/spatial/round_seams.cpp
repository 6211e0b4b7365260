// Capsules at seams in space: gaps to terrain, flat tiles and the pieces of a cut polytope against those to the whole.
#include <orthant/core/mechanics/spatial/height_field.h>
#include "tests/support/round_shapes.h"

#include <doctest/doctest.h>

using namespace orthant;

namespace {

/// Whether an end of a capsule is outside a square about the origin, of sides 2 `half`.
bool outside_square(const spatial::Shape& shape, const spatial::Pose& pose, double half) {
  return std::any_of(shape.corners.begin(), shape.corners.end(), [&](const Vector3d& end) {
    const Vector3d x = pose.x + pose.turn(end);
    return std::max(std::abs(x.x()), std::abs(x.y())) > half;
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

TEST_CASE("a capsule over terrain is as far from it as from the nearest prism, over flat tiles without a ghost") {
  Random random(11);
  int near = 0;
  for (int k = 0; k < 60; ++k) {
    Eigen::MatrixXd heights = Eigen::MatrixXd::Zero(5, 5);
    if (k % 3 != 0)
      for (Eigen::Index i = 0; i < heights.size(); ++i)
        heights(i) = k % 3 == 1 ? random.uniform(-0.4, 0.4) : random.integer(0, 2) * 0.2;
    const spatial::Collision c = over_ground(heights, capsule_along_x(0, random.uniform(0.05, 0.8)));
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
      CAPTURE(k);
      CAPTURE(p);
      const PlacedShape capsule{c.shapes[0], pose};
      const double lowest = std::min(capsule.end(false).z(), capsule.end(true).z());
      if (k % 3 == 0 && lowest > -0.3 && !outside_square(c.shapes[0], pose, 0.65))
        CHECK(std::abs(together - (lowest - kRodRadius)) < 1e-9);
      if (alone < -kRodRadius + 1e-9) continue;  // its core is in the ground
      ++near;
      CHECK(std::abs(together - alone) < 1e-9);
      if (k % 3 != 0 || outside_square(c.shapes[0], pose, 1)) continue;
      for (std::size_t i = 1; i < c.shapes.size(); ++i) {
        const spatial::TouchPoints points = touch(pose, c.shapes[0], here, c.shapes[i]);
        for (int q = 0; q < points.count; ++q) CHECK(points.at(q).n.z() > 0.999);
      }
    }
  }
  CHECK(near > 1000);
}

TEST_CASE("a capsule is as far from the pieces of a cut polytope as from the whole, its core outside or through it") {
  Random random(7);
  int outside = 0, through = 0, off = 0;
  for (int k = 0; k < 200; ++k) {
    std::vector<Vector3d> corners;
    for (int i = 6 + k % 5; i > 0; --i) corners.push_back(0.5 * anywhere_in(random, 1).normalized());
    const spatial::Hull whole = spatial::hull_of(corners);
    const Vector3d n = anywhere_in(random, 1).normalized();
    spatial::Shape low{1, {}, 0}, high{1, {}, 0};
    for (const Vector3d& p : whole.corners) (n.dot(p) < 0 ? low : high).corners.push_back(p);
    for (const spatial::Hull::Edge& e : whole.edges) {
      const Vector3d &p = whole.corners[static_cast<std::size_t>(e.from)],
                     &q = whole.corners[static_cast<std::size_t>(e.to)];
      if ((n.dot(p) < 0) == (n.dot(q) < 0)) continue;
      const Vector3d on = p + n.dot(p) / (n.dot(p) - n.dot(q)) * (q - p);
      low.corners.push_back(on), high.corners.push_back(on);
    }
    if (low.corners.size() < 4 || high.corners.size() < 4) continue;  // all of it on one side
    spatial::Shape entire{2, whole.corners, 0};
    const spatial::Collision c = hulled({capsule_along_x(0, random.uniform(0.05, 0.8)), low, high, entire});
    const spatial::Pose here;
    for (int p = 0; p < 20; ++p) {
      const spatial::Pose pose = pose_at_gap(random, c.shapes[0], {c.shapes[3], here}, random.uniform(-0.16, 0.02));
      const double gap = true_gap({c.shapes[0], pose}, {c.shapes[3], here});
      double together = kNowhere;
      for (std::size_t i = 1; i < 3; ++i)
        together = std::min(together, smallest_gap(touch(pose, c.shapes[0], here, c.shapes[i])));
      CAPTURE(k);
      CAPTURE(p);
      if (gap > -kRodRadius) {
        ++outside;
        CHECK(std::abs(together - gap) < 1e-9);
      } else {  // each piece knows its own part of the core only
        ++through, off += std::abs(together - gap) > 1e-3;
        CHECK(std::abs(together - gap) < 0.15);
      }
    }
  }
  CHECK(outside > 2000);
  CHECK(off < through / 30);
}
