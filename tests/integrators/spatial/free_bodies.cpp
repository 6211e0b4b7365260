// Free bodies and tops in space: what a step keeps exactly, and its order where it does not.
#include "experiments/support/fit_order.h"
#include "tests/support/spatial.h"

#include <orthant/core/scenes/top.h>

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

TEST_CASE("a free asymmetric body keeps its energy and angular momentum to rounding at any step") {
  const SpatialSystem system(tumbling());
  const State start = system.initial_state();
  const Vector3d L = angular_momentum(system, start);
  for (const double h : {0.2, 0.03, 1e-3}) {
    CAPTURE(h);
    double energy_off = 0, momentum_off = 0, unit_off = 0, flipped = 1;
    run_in_space(system, "moreau-jean", h, 50, [&](const SpatialSample& m) {
      energy_off = std::max(energy_off, std::abs(energy(system, m.state) / energy(system, start) - 1));
      momentum_off = std::max(momentum_off, (angular_momentum(system, m.state) - L).norm() / L.norm());
      unit_off = std::max(unit_off, std::abs(quaternion(m.state.q, 0).norm() - 1));
      flipped = std::min(flipped, m.state.v[4] / start.v[4]);
    });
    CHECK(energy_off < 1e-11);
    CHECK(momentum_off < 1e-10);
    CHECK(unit_off < 1e-15);
    CHECK(flipped < -0.9);  // it did tumble
  }
}

TEST_CASE("a free asymmetric body: order 2 of its orientation") {
  const SpatialSystem system(tumbling());
  const Run exact = run_in_space(system, "moreau-jean", 1e-4, 4);
  const Fit fit = fit_order({.coarsest = 0.05, .octaves = 4, .steps_per_octave = 4, .duration = 4}, [&](double h) {
    const Run run = run_in_space(system, "moreau-jean", h, 4);
    return quaternions::turn_between(quaternion(exact.final.q, 0), quaternion(run.final.q, 0)).norm();
  });
  MESSAGE("order " << fit.order << ", scatter " << fit.scatter);
  CHECK(std::abs(fit.order - 2) < 0.1);
  CHECK(fit.scatter < 0.1);
}

TEST_CASE("Lagrange's top with cusps: nutation, its period and the precession in it, order 2") {
  const SpatialSystem system(top());
  constexpr double kPeriod = 0.10996771481, kLargest = 31.68007640528, kPrecession = 0.18417249693;
  double largest = 0, precession = 0;
  const auto error = [&](double h) {
    largest = 0;
    run_in_space(system, "moreau-jean", h, kPeriod, [&](const SpatialSample& m) {
      const Vector3d axis = quaternions::matrix_of(quaternion(m.state.q, 0)).col(2);
      largest = std::max(largest, std::acos(axis.z()) * 180 / std::numbers::pi);
      precession = std::atan2(axis.y(), axis.x());
    });
    return std::abs(precession - kPrecession);
  };
  const Fit fit = fit_order({.coarsest = 4e-4, .octaves = 4, .steps_per_octave = 3, .duration = kPeriod}, error);
  MESSAGE("order " << fit.order << ", scatter " << fit.scatter << ", error " << fit.worst.back().error);
  CHECK(std::abs(fit.order - 2) < 0.1);
  CHECK(fit.worst.back().error < 1e-5);
  CHECK(std::abs(largest - kLargest) < 2e-4);
}

TEST_CASE("a sleeping top stays upright above its critical spin and falls below") {
  for (const double spin : {51.0, 48.0}) {  // critical: 49.522722058 rad/s
    CAPTURE(spin);
    Top p;
    p.tilt = 0.01, p.spin = spin;
    const SpatialSystem system(top(p));
    double lowest = 1;
    run_in_space(system, "moreau-jean", 5e-4, 10, [&](const SpatialSample& m) {
      lowest = std::min(lowest, quaternions::matrix_of(quaternion(m.state.q, 0))(2, 2));
    });
    CHECK((std::acos(lowest) * 180 / std::numbers::pi < 1) == (spin > 49.522722058));
  }
}

TEST_CASE("forces and moments in the body's frame: a rocket that turns evenly flies a circle") {
  // a = F/m turns with ω: v = (a/ω)(sin ωt, 1 − cos ωt), x = (a/ω²)(1 − cos ωt, ωt − sin ωt).
  spatial::Scene s;
  const auto rocket = s.body({.name = "rocket", .mass = 2, .omega = {0, 0, 3}});
  s.load({.name = "jet", .body = rocket, .force = {4, 0, 0}, .frame = spatial::Frame::body});
  const SpatialSystem system(s);
  const auto error = [&](double h) {
    const Run run = run_in_space(system, "moreau-jean", h, 1);
    const double a = 2, w = 3;
    const Vector3d exact(a / w / w * (1 - std::cos(w)), a / w / w * (w - std::sin(w)), 0);
    return (Vector3d(place_of<Spatial>(run.final.q, 0)) - exact).norm();
  };
  const Fit fit = fit_order({.coarsest = 0.02, .octaves = 4, .steps_per_octave = 3, .duration = 1}, error);
  CHECK(std::abs(fit.order - 2) < 0.1);
  CHECK(fit.worst.back().error < 1e-5);
}
