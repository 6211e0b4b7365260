// Overlap at the start in space: states within inner steps and the reported gaps are those of the motion.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/spatial/solid.h>

#include <doctest/doctest.h>

#include <algorithm>

using namespace orthant;

namespace {

/// A driven ball pushes another one, which overlaps it by 5 mm at the start, against an oblique wall 10 mm away.
spatial::Scene pushed_in_overlap() {
  spatial::Scene s;
  s.gravity = {-2, 0, 0};  // keeps the balls in touch
  const spatial::Solid small = spatial::sphere(0.02), large = spatial::sphere(0.05);
  const BodyId pusher = s.body({.inertia = small.inertia, .velocity = {1, 0, 0}});
  const BodyId ball = s.body({.inertia = large.inertia, .position = {0.065, 0, 0}});
  s.joint(spatial::Prismatic{.name = "guide", .a = kGround, .b = pusher, .axis = {1, 0, 0}});
  s.joint(spatial::Drive{.name = "drive",
                         .of = spatial::Slide{kGround, pusher, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}},
                         .law = {.rate_of_change = 1}});
  s.contact(spatial::SphereSphere{.name = "push", .a = ball, .radius_a = 0.05, .b = pusher, .radius_b = 0.02});
  const Vector3d n = Vector3d(-1, 0, 1).normalized();
  s.contact(spatial::SpherePlane{.name = "wall",
                                 .a = ball,
                                 .radius = 0.05,
                                 .plane_point = Vector3d(0.065, 0, 0) - 0.06 * n,
                                 .normal = n,
                                 .law = {.e = 0.5}});
  return s;
}

}  // namespace

TEST_CASE("in space: where bodies overlap at the start, gaps are those of the states, and no other body is entered") {
  const SpatialSystem system(pushed_in_overlap());
  TermsOf<Spatial> terms(system);
  for (const std::string_view scheme : {"event-driven", "adaptive:rtol=1e-9"}) {
    CAPTURE(scheme);
    double overlap = 0, off = 0, wall = 1, left = 0;
    int rows = 0;
    run_in_space(system, scheme, 1e-3, 0.03, [&](const RunSampleOf<Spatial>& moment) {
      if (++rows == 1) return;  // the start has no gaps
      set_poses(system, moment.state.t, moment.state.q, terms.at);
      evaluate_gaps(system, terms);
      off = std::max(off, (terms.gap - moment.gaps).lpNorm<Eigen::Infinity>());
      overlap = std::max(overlap, -moment.gaps[0]), wall = std::min(wall, moment.gaps[1]);
      if (moment.state.t < 0.01) left = std::max(left, std::abs(moment.gaps[0] + 0.005));  // before it strikes
    });
    CHECK(std::abs(overlap - 0.005) < 1e-9);
    CHECK(left < 1e-9);
    CHECK(off < 1e-9);
    CHECK(wall > -1e-7);
    CHECK(wall < 0.005);
  }
}
