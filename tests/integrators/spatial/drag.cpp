// Drag in space against closed forms, at any step; independent of the frame.
#include "experiments/support/fit_order.h"
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <cmath>
#include <string>

using namespace orthant;

namespace {

constexpr std::string_view kDragged[] = {"moreau-jean",       "stewart-trinkle", "anitescu-potra", "paoli-schatzman",
                                         "generalized-alpha", "rattle",          "adaptive",       "event-driven"};

/// A ball of 2 kg with the velocity (3, -4, 12) m/s, 13 m/s, and 26 rad/s along the same direction.
spatial::Scene dragged_ball(const std::string& drag) {
  return std::get<spatial::Scene>(parse_any_scene(
      "dimension = 3\n[[body]]\nname = 'ball'\nmass = 2\ninertia = 0.5\nvelocity = [3, -4, 12]\nomega = [6, -8, 24]\n"
      "orientation = [0.5, 0.5, -0.5, 0.5]\n[[spring]]\ntype = 'drag'\nname = 'air'\nbody = 'ball'\n" +
          drag,
      {}, "drag.toml"));
}

Vector3d centre_velocity(const State& x) { return translation<Spatial>(x.v, 0); }

}  // namespace

TEST_CASE("linear drag slows a body down as exp(-c t / m), its turning likewise: order 2 of the smooth schemes") {
  const SpatialSystem system(dragged_ball("linear = 0.8\nangular = 0.3\n"));
  const Vector3d v = std::exp(-0.4) * Vector3d(3, -4, 12), w = std::exp(-0.6) * Vector3d(6, -8, 24);
  for (const std::string_view scheme : {"moreau-jean", "rattle", "generalized-alpha"}) {
    CAPTURE(scheme);
    const Fit fit = fit_order({.coarsest = 4e-2, .octaves = 4, .steps_per_octave = 2, .duration = 1}, [&](double h) {
      const Run run = run_in_space(system, scheme, h, 1);
      return (centre_velocity(run.final) - v).norm() + (world_omega(system, run.final, 0) - w).norm();
    });
    CHECK(std::abs(fit.order - 2) < 0.1);
  }
  for (const std::string_view scheme : {"adaptive", "event-driven"}) {
    CAPTURE(scheme);
    const Run run = run_in_space(system, scheme, 0.1, 1);
    CHECK((centre_velocity(run.final) - v).norm() < (scheme == "adaptive" ? 1e-7 : 1e-11));
    CHECK((world_omega(system, run.final, 0) - w).norm() < (scheme == "adaptive" ? 1e-7 : 1e-11));
  }
}

TEST_CASE("quadratic drag slows a body down as 1 / (1 + c v t / m) along its path, by every integrator") {
  const SpatialSystem system(dragged_ball("quadratic = 0.5\n"));
  const double s = 1 / (1 + 0.25 * 13);
  for (const std::string_view scheme : kDragged) {
    CAPTURE(scheme);
    const Run run = run_in_space(system, scheme, 1e-3, 1);
    REQUIRE(run.status == Status::solved);
    const double off = (centre_velocity(run.final) - s * Vector3d(3, -4, 12)).norm();
    MESSAGE(scheme << ": " << off);
    CHECK(off < (scheme == "event-driven" ? 1e-10 : scheme == "adaptive" ? 1e-6 : 2e-2));
    CHECK(run.energy_rises == 0);
  }
}

TEST_CASE("drag that stops a body within a thousandth of a step does not throw it back") {
  const SpatialSystem system(dragged_ball("linear = 2e6\nangular = 2e6\n"));
  for (const std::string_view scheme : {"moreau-jean:theta=1", "generalized-alpha"}) {
    CAPTURE(scheme);
    const Run run = run_in_space(system, scheme, 1e-2, 0.5);
    CHECK(centre_velocity(run.final).norm() < 1e-3);
    CHECK(world_omega(system, run.final, 0).norm() < 1e-3);
  }
}

TEST_CASE("drag at a point of a body turns it: what its centre loses, the couple has") {
  // Force −c u at r from the centre of a body at rest that turns: du of the centre and moment r × F, to first order.
  const auto force = [](const std::string& law) {
    const SpatialSystem system(std::get<spatial::Scene>(parse_any_scene(
        "dimension = 3\n[[body]]\nname = 'vane'\nmass = 2\ninertia = 0.5\nomega = [0, 0, 3]\n[[spring]]\n"
        "type = 'drag'\nbody = 'vane'\npoint = [0.2, 0, 0]\n" +
            law,
        {}, "vane.toml")));
    TermsOf<Spatial> terms(system);
    const State x = system.initial_state();
    set_poses(system, 0, x.q, terms.at);
    evaluate_forces(system, 0, x.v, terms);
    return Eigen::VectorXd(terms.f);
  };
  const Eigen::VectorXd linear = force("linear = 4\n"), quadratic = force("quadratic = 5\n");
  CHECK(std::abs(linear[1] + 4 * 0.6) < 1e-14);  // the point moves along y with 0.6 m/s
  CHECK(std::abs(linear[5] + 4 * 0.6 * 0.2) < 1e-14);
  CHECK(std::abs(quadratic[1] + 5 * 0.6 * 0.6) < 1e-14);
  CHECK(std::abs(quadratic[5] + 5 * 0.6 * 0.6 * 0.2) < 1e-14);
}

TEST_CASE("mistakes in drag are named by field, value and rule") {
  const auto refused = [](const std::string& keys) -> std::string {
    try {
      dragged_ball(keys);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  CHECK(refused("linear = -1\n").find("linear = -1: must be >= 0") != std::string::npos);
  CHECK(refused("linear = 0\n").find("must be at least one > 0") != std::string::npos);
  CHECK(refused("linear = 1\nstiffness = 3\n").find("stiffness") != std::string::npos);
}
