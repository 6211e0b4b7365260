// Contacts with friction discs in space against exact solutions.
#include "experiments/support/fit_order.h"
#include "tests/support/spatial.h"

#include <orthant/core/scenes/masse.h>

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

namespace {

spatial::Scene ball_on_floor(double height, const Vector3d& v, const Vector3d& omega, const ContactLaw& law) {
  constexpr double kRadius = 0.1, kMass = 2;
  spatial::Scene s;
  const auto ball = s.body({.name = "ball",
                            .mass = kMass,
                            .inertia = Vector3d::Constant(0.4 * kMass * kRadius * kRadius).asDiagonal(),
                            .position = {0, 0, kRadius + height},
                            .velocity = v,
                            .omega = omega});
  s.contact(spatial::SpherePlane{"floor", ball, {0, 0, 0}, kRadius, kGround, {0, 0, 0}, {0, 0, 1}, law});
  return s;
}

}  // namespace

TEST_CASE("a superball that slips: velocities after the impact are exact, whatever the step") {
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle"})
    for (const double h : {1e-2, 1e-3}) {
      CAPTURE(scheme);
      CAPTURE(h);
      const SpatialSystem system(ball_on_floor(0.05, {2, 1, -3}, {10, -20, 5}, {.mu = 0.1, .e = 0.5}));
      const Run run = run_in_space(system, scheme, h, 0.1);
      CHECK((Vector3d(translation<Spatial>(run.final.v, 0)) - Vector3d(1.597507764050, 0.798753882025, 1.5)).norm() <
            1e-11);
      CHECK((world_omega(system, run.final, 0) - Vector3d(4.968847050625, -9.937694101251, 5)).norm() < 1e-10);
    }
}

TEST_CASE("a superball that sticks with e_t = 1 returns its slip") {
  // J = 2/5 m R²: slip u = v + ω × (−R n); the tangential impulse for u⁺ = −u⁻ is −2 u⁻ (1/m + R²/J)⁻¹ = −4/7 m u⁻.
  const Vector3d v(0.4, -0.3, -3), omega(3, 2, 5), r(0, 0, -0.1);
  const SpatialSystem system(ball_on_floor(0.05, v, omega, {.mu = 10, .e = 1, .e_t = 1}));
  const Run run = run_in_space(system, "moreau-jean", 1e-3, 0.1);
  Vector3d slip = v + omega.cross(r);
  slip.z() = 0;
  const Vector3d impulse = -4.0 / 7 * 2 * slip;
  CHECK((Vector3d(translation<Spatial>(run.final.v, 0)) - (Vector3d(v.x(), v.y(), 3) + impulse / 2)).norm() < 1e-10);
  CHECK((world_omega(system, run.final, 0) - (omega + r.cross(impulse) / (0.4 * 2 * 0.01))).norm() < 1e-9);
  CHECK(std::abs(run.energy_final - run.energy_initial) < 1e-9);
}

TEST_CASE("a massé shot slides on a parabola and rolls on: order 1 or better, the velocity exact") {
  const SpatialSystem system(masse());
  constexpr double kRolls = 0.6147302241381;
  const Vector3d roll(-0.102142857142857, 0.489857142857143, 0);
  const Vector3d exact = Vector3d(0.275969961, 0.150564996, 0.028575) + (1 - kRolls) * roll;
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle"}) {
    CAPTURE(scheme);
    const Run run = run_in_space(system, scheme, 1e-4, 1);
    const double off = (Vector3d(place_of<Spatial>(run.final.q, 0)) - exact).norm();
    CHECK(off < (scheme == "moreau-jean" ? 1e-8 : 1e-4));
    CHECK((Vector3d(translation<Spatial>(run.final.v, 0)) - roll).norm() < 1e-11);
    CHECK((world_omega(system, run.final, 0) - Vector3d(-17.142857142857, -3.574553180855, 40)).norm() < 1e-9);
    CHECK(run.max_penetration < 1e-12);
  }
  const Fit fit = fit_order({.coarsest = 4e-3, .octaves = 4, .steps_per_octave = 4, .duration = 1}, [&](double h) {
    const Run run = run_in_space(system, "stewart-trinkle", h, 1);
    return (Vector3d(place_of<Spatial>(run.final.q, 0)) - exact).norm();
  });
  CHECK(std::abs(fit.order - 1) < 0.1);
}

TEST_CASE("two spheres with friction: throw of a cue ball, sticking and slipping") {
  // Equal spheres of radius R at speed 1, cut angle φ from the line of centres, e = 1, μ = .06: the tangential impulse
  // over m is (1 / (2 · 7/2)) sin φ where it sticks, μ cos φ where it slips.
  for (const auto& [cut, thrown] : {std::pair{15.0, 0.0369741493}, std::pair{30.0, 0.0519615242}}) {
    CAPTURE(cut);
    const double phi = cut * std::numbers::pi / 180, R = 0.03;
    spatial::Scene s;
    const Eigen::Matrix3d J = Vector3d::Constant(0.4 * R * R).asDiagonal();
    s.body({.name = "cue",
            .inertia = J,
            .position = {-2 * R - 0.01 * std::cos(phi), -0.01 * std::sin(phi), 0},
            .velocity = {std::cos(phi), std::sin(phi), 0}});
    s.body({.name = "object", .inertia = J});
    s.contact(spatial::SphereSphere{"touch", 0, {0, 0, 0}, R, 1, {0, 0, 0}, R, {.mu = 0.06, .e = 1}});
    const SpatialSystem system(s);
    const Run run = run_in_space(system, "moreau-jean", 1e-5, 0.015);
    CHECK(std::abs(run.final.v[6] - std::cos(phi)) < 1e-4);
    CHECK(std::abs(run.final.v[7] - thrown) < 1e-4);
  }
}

TEST_CASE("a ball in a socket with clearance swings like a pendulum of the length of the clearance") {
  // Frictionless: the centre moves as a point mass on a sphere of the radius R − r. Small swings: ω² = g/(R − r).
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  const double play = 0.1, tilt = 0.05;
  s.body({.name = "ball", .position = play * Vector3d(std::sin(tilt), 0, -std::cos(tilt))});
  s.contact(spatial::Socket{"socket", 0, {0, 0, 0}, 0.4, kGround, {0, 0, 0}, 0.5, {}});
  const SpatialSystem system(s);
  const double period = 2 * std::numbers::pi * std::sqrt(play / 9.81) * (1 + tilt * tilt / 16);
  const Run run = run_in_space(system, "moreau-jean", period / 4000, period);
  CHECK(std::abs(run.final.q[0] - play * std::sin(tilt)) < 2e-5 * play);
  CHECK(run.max_penetration < 1e-6);
}

TEST_CASE("a box slides across a slope: friction opposes the whole slip, and it stops when it should") {
  // No gravity along the floor, v (3, 4): decelerates at μ g to 0 after |v|²/(2 μ g), along its way.
  spatial::Scene s;
  s.gravity = {0, 0, -10};
  const double h = 1e-3;
  const auto box = s.body({.name = "box",
                           .inertia = Vector3d(1.0 / 6, 1.0 / 6, 1.0 / 6).asDiagonal(),
                           .position = {0, 0, 0.1},
                           .velocity = {0.3, 0.4, 0}});
  s.contact_set(
      spatial::corners_plane({.name = "floor", .a = box, .law = {.mu = 0.5}}, spatial::box_corners({0.5, 0.5, 0.1})));
  const SpatialSystem system(s);
  const Run run = run_in_space(system, "moreau-jean", h, 0.5);
  CHECK((Vector3d(place_of<Spatial>(run.final.q, 0)) - Vector3d(0.015, 0.02, 0.1)).norm() < 1e-6);
  CHECK(run.final.v.lpNorm<Eigen::Infinity>() < 1e-10);
}

TEST_CASE("an integrator of no known name in space is refused with the names of all that take such scenes") {
  const SpatialSystem system(masse());
  CHECK_THROWS_WITH_AS(
      static_cast<void>(make_integrator("euler", system)),
      "unknown integrator 'euler': must be one of moreau-jean, stewart-trinkle, anitescu-potra, paoli-schatzman, "
      "generalized-alpha, rattle, adaptive, event-driven",
      std::invalid_argument);
}
