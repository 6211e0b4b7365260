// The clock and the arm on cables of core/scenes: what a train, an escapement and cables have to keep.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <cmath>
#include <numbers>

#include "tests/support/scene_texts.h"

namespace orthant {
namespace {

double angle_of(const State& x, BodyId body) { return x.q[3 * body + 2]; }

/// Along pulleys that are points of the ground, from a point of one body to a point of the other.
double cable(const State& x, BodyId a, BodyId b, double on_b, const Vector2d& pulley) {
  const Vector2d end = x.q.segment<2>(3 * b) + on_b * Vector2d(std::cos(angle_of(x, b)), std::sin(angle_of(x, b)));
  return (x.q.segment<2>(3 * a) - pulley).norm() + (end - pulley).norm();
}

}  // namespace

TEST_CASE("a clock: one pin of the escape wheel passes in each swing of the anchor, and energy only falls") {
  enum { barrel, centre, third, escape, anchor };
  for (const char* scheme : {"moreau-jean", "stewart-trinkle"}) {
    CAPTURE(scheme);
    const System system(read_scene(scene_texts::kCore / "scenes" / "clock_movement.toml"));
    const auto integrator = make_integrator(scheme, system);
    const auto solver = make_solver("auto");
    double before = kInf, rise = 0, last = 0, off_train = 0, first_angle = 0, angle = 0;
    int swings = 0;
    const Run run = simulate(*integrator, *solver, {.step = 1e-4, .duration = 1.2}, [&](const RunSample& moment) {
      const double now = energy(system, moment.state), swing = angle_of(moment.state, anchor);
      rise = std::max(rise, now - before), before = now;
      off_train = std::max(off_train, std::abs(angle_of(moment.state, escape) + 64 * angle_of(moment.state, barrel)));
      if (moment.state.t > 0.3 && last < 0 && swing >= 0) {  // it has swung in by then
        angle = angle_of(moment.state, escape);
        if (swings++ == 0) first_angle = angle;
      }
      last = swing;
    });
    REQUIRE(run.status == Status::solved);
    CHECK(run.max_joint_residual < 1e-12);
    CHECK(off_train < 1e-11);
    CHECK(rise < 1e-11);  // [J] of 0.08 J in the mainspring
    CHECK(swings >= 3);
    // The wheel turns by one pitch in each swing, to a part of a pitch: a crossing may fall anywhere in its drop.
    const double pitches = (first_angle - angle) / (2 * std::numbers::pi / 15);
    CHECK(std::abs(pitches - (swings - 1)) < 0.25);
    CHECK(run.max_penetration < 2e-5);  // [m] of pins of 0.3 mm
  }
}

TEST_CASE("an arm on cables: they keep their lengths, stay taut, and two schemes agree") {
  enum { upper, fore, elbow_winch, hand_winch, weight };
  Eigen::VectorXd ends[2];
  for (const int which : {0, 1}) {
    const char* scheme = which == 0 ? "moreau-jean" : "stewart-trinkle";
    CAPTURE(scheme);
    const System system(read_scene(scene_texts::kCore / "scenes" / "cable_arm.toml"));
    const auto integrator = make_integrator(scheme, system);
    const auto solver = make_solver("auto");
    double off = 0, least_pull = kInf;
    const Run run = simulate(*integrator, *solver, {.step = 1e-3, .duration = 4}, [&](const RunSample& moment) {
      const State& x = moment.state;
      off = std::max({off, std::abs(cable(x, elbow_winch, upper, 0.2, {0, 0.3}) - 1.1),
                      std::abs(cable(x, hand_winch, fore, 0.15, {0.2, 0.7}) - 0.8 - std::sqrt(0.74)),
                      std::abs(cable(x, weight, fore, 0.15, {1.2, -0.3}) - 0.6 - std::sqrt(0.34))});
      if (x.t > 0.1)
        for (const Impulse& pull : moment.impulses) least_pull = std::min(least_pull, pull.normal / 1e-3);
    });
    REQUIRE(run.status == Status::solved);
    CHECK(run.max_joint_residual < 1e-12);
    CHECK(off < (which == 0 ? 5e-4 : 2e-6));  // [m] rates against lengths
    CHECK(least_pull > 0.1);                  // [N]
    ends[which] = run.final.q;
  }
  CHECK((ends[0] - ends[1]).lpNorm<Eigen::Infinity>() < 2e-3);
}

}  // namespace orthant
