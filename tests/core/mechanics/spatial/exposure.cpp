// Adjacent polytopes of a body act as one surface: seams have no contacts, ridges and summits have theirs.
#include <orthant/core/mechanics/spatial/collision.h>
#include <orthant/core/mechanics/spatial/height_field.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace orthant;

namespace {

using SpatialPose = orthant::spatial::Pose;
constexpr double kRadius = 0.1;  // [m]

double least_gap(const spatial::TouchPoints& points) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < points.count; ++i) least = std::min(least, points.points[static_cast<std::size_t>(i)].gap);
  return least;
}

/// The least gap of the first shape, at a place, to all others: as parts of one body, and each as a body of its own.
struct Gaps {
  double together = std::numeric_limits<double>::infinity(), alone = together;
};
class Surface {
 public:
  Surface(const spatial::Shape& over, const std::vector<spatial::Shape>& parts) {
    whole_.shapes = {over};
    whole_.shapes.insert(whole_.shapes.end(), parts.begin(), parts.end());
    spatial::set_hulls(whole_);
    for (const spatial::Shape& part : parts) {
      apart_.emplace_back().shapes = {over, part};
      spatial::set_hulls(apart_.back());
    }
  }
  Gaps gaps(const Vector3d& at) const {
    SpatialPose there, here;
    there.x = at;
    Gaps gaps;
    for (std::size_t i = 0; i < apart_.size(); ++i) {
      const double together = least_gap(touch(there, whole_.shapes[0], here, whole_.shapes[i + 1]));
      const double alone = least_gap(touch(there, apart_[i].shapes[0], here, apart_[i].shapes[1]));
      gaps.together = std::min(gaps.together, together), gaps.alone = std::min(gaps.alone, alone);
    }
    return gaps;
  }

 private:
  spatial::Collision whole_;
  std::vector<spatial::Collision> apart_;
};

spatial::HeightField roof() {
  spatial::HeightField field{.origin = {-1, -1, 0}, .heights = Eigen::MatrixXd::Zero(3, 3)};
  field.heights.row(1).setConstant(0.2);
  return field;
}

}  // namespace

TEST_CASE("a ball over terrain is as far from it as from the nearest cell: no ridge or summit is lost") {
  Random random(11);
  const spatial::Shape ball{0, {{0, 0, 0}}, kRadius};
  int near = 0;
  for (int k = 0; k < 40; ++k) {
    spatial::HeightField field{.origin = {-2, -2, 0}, .heights = Eigen::MatrixXd::Zero(5, 5)};
    for (Eigen::Index i = 0; i < 25; ++i)
      field.heights(i) = k % 2 == 0 ? random.uniform(-0.5, 0.5) : random.integer(0, 2) * 0.25;
    const Surface surface(ball, shapes_of(field, kGround));
    for (int p = 0; p < 100; ++p) {
      const Vector3d at(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-0.5, 0.8));
      const Gaps gaps = surface.gaps(at);
      if (gaps.alone < -kRadius + 1e-9) continue;  // its centre is in the ground
      ++near;
      CAPTURE(k);
      CAPTURE(at);
      CHECK(std::abs(gaps.together - gaps.alone) < 1e-12);
    }
  }
  CHECK(near > 1000);
}

TEST_CASE("a box lies across a ridge, a ball rests on it, and nothing collides with a flat seam") {
  const spatial::Shape ball{0, {{0, 0, 0}}, kRadius}, box{0, spatial::box_corners({0.3, 0.2, 0.1}), 0};
  const Surface under_ball(ball, shapes_of(roof(), kGround)), under_box(box, shapes_of(roof(), kGround));
  for (const double x : {0.0, 1e-3, -1e-3, 0.01}) {
    CHECK(std::abs(under_ball.gaps({x, 0.1, 0.2 + kRadius}).together - (std::hypot(x, kRadius) - kRadius)) < 1e-12);
    CHECK(std::abs(under_box.gaps({x, 0.1, 0.3 - 1e-6}).together + 1e-6) < 1e-12);
  }
  spatial::HeightField flat{.origin = {-1, -1, 0}, .heights = Eigen::MatrixXd::Zero(3, 3)};
  spatial::Collision c{.name = "floor", .shapes = shapes_of(flat, kGround), .law = {}};
  c.shapes.push_back(box);
  spatial::set_hulls(c);
  SpatialPose here, there;
  for (const double x : {-0.3, -0.3 + 1e-9, 0.0, 0.25}) {
    there.x = {x, 0, 0.1 - 1e-6};
    for (std::size_t i = 0; i + 1 < c.shapes.size(); ++i) {
      const spatial::TouchPoints points = touch(there, c.shapes.back(), here, c.shapes[i]);
      for (int k = 0; k < points.count; ++k)
        if (points.points[static_cast<std::size_t>(k)].gap < 1e-3)
          CHECK(points.points[static_cast<std::size_t>(k)].n.z() > 0.999);
    }
  }
}
