// The first guess of a step's impulses in space: each contact's own of the step before, whatever others do.
#include "tests/support/spatial.h"

#include <orthant/core/scenes/motion.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

constexpr double kRadius = 0.05, kStep = 1e-3;
constexpr int kHigh = 12;

/// A column of spheres at rest, and one apart from it that falls onto the floor. Its pair comes before all others.
spatial::Scene column_and_ball() {
  spatial::Scene s;
  s.gravity = {0, 0, -kGravity};
  spatial::Collision all{.name = "c", .shapes = {}, .law = {.mu = 0.3}};
  all.shapes.push_back({kGround, spatial::box_corners({2, 2, 0.5})});
  for (Vector3d& corner : all.shapes[0].corners) corner.z() -= 0.5;
  for (int i = -1; i < kHigh; ++i) {
    const double up = i < 0 ? kRadius + 0.01 : (2 * i + 1) * kRadius;
    const auto body = s.body({.name = "b" + std::to_string(i + 1),
                              .inertia = 1e-3 * Eigen::Matrix3d::Identity(),
                              .position = {i < 0 ? 1.0 : 0.0, 0, up}});
    all.shapes.push_back({body, {Vector3d::Zero()}, kRadius});
  }
  s.collision(std::move(all));
  return s;
}

}  // namespace

TEST_CASE("a contact that closes elsewhere costs the others no sweep; a checkpoint keeps their guess") {
  const SpatialSystem system(column_and_ball());
  const auto scheme = make_integrator("moreau-jean", system);
  const auto solver = make_solver("pgs:tolerance=1e-9");
  State x = system.initial_state();
  const int cold = [&] {
    const StepReport first = scheme->step(kStep, *solver, x);
    REQUIRE(first.status == Status::solved);
    CHECK(scheme->problem().size() == 3 * kHigh);
    return first.lcp_iterations;
  }();
  REQUIRE(cold > 200);
  bool landed = false;
  for (int k = 0; k < 100 && !landed; ++k) {
    CheckpointData written;
    scheme->remember(written);
    State again = x;
    const StepReport report = scheme->step(kStep, *solver, x);
    REQUIRE(report.status == Status::solved);
    landed = scheme->problem().size() == 3 * (kHigh + 1);
    if (!landed) continue;
    CHECK(report.lcp_iterations < cold / 20);
    const auto resumed = make_integrator("moreau-jean", system);
    const auto fresh = make_solver("pgs:tolerance=1e-9");
    CheckpointData read(written.bytes());
    resumed->remember(read), read.end();
    CHECK(resumed->step(kStep, *fresh, again).lcp_iterations == report.lcp_iterations);
    CHECK(again.v == x.v);
  }
  CHECK(landed);
}
