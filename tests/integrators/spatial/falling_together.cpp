// Balls that fall in touch with each other: a contact without force, nearly without turn, in frames turned at random.
#include "tests/support/spatial.h"

#include <orthant/core/support/random.h>
#include <orthant/integrators/adaptive/crossing_state.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

/// A ball rests on the floor. Two others, one on top of the other, fall on it beside its middle.
spatial::Scene falling_stack(const Eigen::Vector4d& turn) {
  const Eigen::Matrix3d R = quaternions::matrix_of(turn);
  spatial::Scene s;
  s.gravity = R * Vector3d(0, 0, -9.81);
  const ContactLaw law{.mu = 2, .e = 1};
  struct {
    const char* name;
    double radius;
    Vector3d place;
  } const balls[] = {
      {"low", 0.108, {-0.014, -0.007, 0.108}}, {"middle", 0.06, {0, 0, 0.297}}, {"high", 0.1, {0, 0, 0.457}}};
  for (const auto& ball : balls)
    s.body({.name = ball.name,
            .inertia = Vector3d::Constant(0.4 * ball.radius * ball.radius).asDiagonal(),
            .position = R * ball.place});
  s.contact(spatial::SpherePlane{"floor", 0, {0, 0, 0}, 0.108, kGround, {0, 0, 0}, R * Vector3d(0, 0, 1), law});
  s.contact(spatial::SphereSphere{"lower", 1, {0, 0, 0}, 0.06, 0, {0, 0, 0}, 0.108, law});
  s.contact(spatial::SphereSphere{"upper", 2, {0, 0, 0}, 0.1, 1, {0, 0, 0}, 0.06, law});
  return s;
}

}  // namespace

TEST_CASE("balls that fall in touch strike the ball below in the same way, however the scene is turned") {
  Random random(7);
  Eigen::Vector4d turn(1, 0, 0, 0);
  Vector3d first(0, 0, 0);
  for (int k = 0; k < 24; ++k) {
    for (const std::string_view integrator : {"event-driven", "adaptive"}) {
      CAPTURE(integrator);
      CAPTURE(k);
      const SpatialSystem system(falling_stack(turn));
      const Run run = run_in_space(system, integrator, 1e-3, 0.08);
      CHECK(run.events > 0);
      CHECK(run.max_penetration < 1e-9);
      const Vector3d place = quaternions::matrix_of(turn).transpose() * Vector3d(place_of<Spatial>(run.final.q, 2));
      if (k == 0) first = place;
      CHECK((place - first).norm() < 1e-6);
    }
    for (Index i = 0; i < 4; ++i) turn[i] = random.normal();
    turn.normalize();
  }
}

TEST_CASE("states within a crossing in space have no more energy than the line between its ends") {
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  s.body({.name = "rod", .inertia = Vector3d(0.2, 0.2, 0.01).asDiagonal(), .velocity = {1, 0, -3}, .omega = {1, 2, 3}});
  const SpatialSystem system(s);
  const State start = system.initial_state();
  for (const double push : {0.0, 1.0}) {
    State end = start;
    end.t = 0.02;
    translation<Spatial>(end.v, 0) = Vector3d(0.5, 0, -3.2), rotation<Spatial>(end.v, 0) = Vector3d(-1, 2, 4);
    move<Spatial>(start.q, 0.01 * (start.v + end.v), end.q);
    const std::vector<ImpulseOf<Spatial>> impulses{{.normal = push}};
    const double e0 = energy(system, start), e1 = energy(system, end);
    for (const double part : {0.01, 0.3, 0.5, 0.99}) {
      State x = start;
      move_within_crossing<Spatial>(part * end.t, end, impulses, x);
      const double bend = push > 0 ? 0 : 9.81 * part * (1 - part) * end.t / 2 * 0.2;  // of the parabola of z
      CHECK(energy(system, x) <= (1 - part) * e0 + part * e1 + bend + 1e-12);
    }
  }
}
