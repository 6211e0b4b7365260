// Anitescu–Potra in space: the plane in space, closed forms, both forms of the problem, objectivity.
#include "experiments/support/fit_order.h"
#include "tests/support/runs.h"
#include "tests/support/spatial.h"

#include <orthant/core/scenes/masse.h>
#include <orthant/core/scenes/slider_crank_space.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

const Eigen::Quaterniond kTurnedRelaxed(Eigen::AngleAxisd(0.9, Vector3d(2, -1, 0.6).normalized()));

/// A box on a floor, pulled along `way` in the plane of the floor, all turned by R.
spatial::Scene pulled_box(const Eigen::Quaterniond& R, const Vector3d& force, const Vector3d& velocity, double mu) {
  spatial::Scene s;
  s.gravity = R * Vector3d(0, 0, -10);
  const auto box = s.body({.name = "box",
                           .inertia = Vector3d(0.01, 0.08, 0.08).asDiagonal(),
                           .position = R * Vector3d(0, 0, 0.1),
                           .orientation = {R.w(), R.x(), R.y(), R.z()},
                           .velocity = R * velocity});
  s.contact_set(spatial::corners_plane({.name = "floor", .a = box, .normal = R * Vector3d(0, 0, 1), .law = {.mu = mu}},
                                       spatial::box_corners({0.5, 0.3, 0.1})));
  s.load({.name = "pull", .body = box, .point = {0, 0, -0.1}, .force = R * force});
  return s;
}

}  // namespace

TEST_CASE("anitescu-potra in space: a box that is pulled from rest, order 1; one that is pulled too little stays") {
  // a = F − μ g along the pull; x = a t² / 2. The contact floats at g_N = μ h v, which vanishes with h.
  const Vector3d pull(3, 4, 0);
  const SpatialSystem system(pulled_box(kTurnedRelaxed, pull, {0, 0, 0}, 0.3));
  for (const std::string_view scheme : {"anitescu-potra", "anitescu-potra:form=full"}) {
    CAPTURE(scheme);
    double float_off = 0;
    const auto error = [&](double h) {
      const Run run = run_in_space(system, scheme, h, 1);
      const Vector3d x = kTurnedRelaxed.inverse() * Vector3d(place_of<Spatial>(run.final.q, 0));
      const double v = Vector3d(translation<Spatial>(run.final.v, 0)).norm();
      float_off = std::max(float_off, std::abs((x.z() - 0.1) / (0.3 * h * v) - 1));
      return std::hypot(x.x() - 0.6, x.y() - 0.8);
    };
    const Fit fit = fit_order({.coarsest = 0.02, .octaves = 4, .steps_per_octave = 3, .duration = 1}, error);
    MESSAGE(scheme << ": order " << fit.order << ", scatter " << fit.scatter << ", error " << fit.worst.back().error
                   << ", height off by " << float_off);
    CHECK(std::abs(fit.order - 1) < 0.1);
    CHECK(fit.worst.back().error < 6e-3);
    CHECK(float_off < 0.1);
  }
  const SpatialSystem held(pulled_box(kTurnedRelaxed, pull, {0, 0, 0}, 0.6));
  const Run stays = run_in_space(held, "anitescu-potra", 1e-3, 1);
  CHECK((Vector3d(place_of<Spatial>(stays.final.q, 0)) - kTurnedRelaxed * Vector3d(0, 0, 0.1)).norm() < 1e-9);
  CHECK(stays.final.v.lpNorm<Eigen::Infinity>() < 1e-9);
}

TEST_CASE("anitescu-potra in space: a box that slides hops as the scheme's header says") {
  // It leaves the floor with the normal velocity μ v / (1 + μ²), whatever h.
  const double mu = 0.25, theory = std::pow(mu * 0.5 / (1 + mu * mu), 2) / (2 * 10);
  const SpatialSystem system(pulled_box(kTurnedRelaxed, {0, 0, 0}, {0.3, 0.4, 0}, mu));
  double most = 0;
  run_in_space(system, "anitescu-potra", 1e-5, 0.05, [&](const SpatialSample& m) {
    most = std::max(most, (kTurnedRelaxed.inverse() * Vector3d(place_of<Spatial>(m.state.q, 0))).z() - 0.1);
  });
  CHECK(std::abs(most - theory) < 0.01 * theory);
}

TEST_CASE("anitescu-potra in space: the planar slider-crank built in space and turned has the planar motion") {
  constexpr double kStep = 1e-5, kDuration = 0.03;
  SliderCrankSpace flat;
  flat.mu = 0.1;
  const Run planar = run_for(slider_crank(flat), kDuration, "anitescu-potra", kStep);
  REQUIRE(planar.status == Status::solved);
  REQUIRE(planar.lcp_solves > 10);
  for (const double turn : {0.0, 1.0})
    for (const double width : {0.0, 0.03})
      for (const std::string_view form : {"anitescu-potra", "anitescu-potra:form=full"}) {
        CAPTURE(turn);
        CAPTURE(width);
        CAPTURE(form);
        SliderCrankSpace p = flat;
        p.turn_x = turn, p.turn_y = 0.5 * turn, p.turn_z = -0.7 * turn, p.width = width;
        const SpatialSystem system(slider_crank_space(p));
        const Run run = run_in_space(system, form, kStep, kDuration);
        const Eigen::Quaterniond R = Eigen::AngleAxisd(p.turn_z, Vector3d::UnitZ()) *
                                     Eigen::AngleAxisd(p.turn_y, Vector3d::UnitY()) *
                                     Eigen::AngleAxisd(p.turn_x, Vector3d::UnitX());
        for (Index b = 0; b < 3; ++b) {
          const Vector3d x = R.inverse() * Vector3d(place_of<Spatial>(run.final.q, b));
          CHECK((x - Vector3d(planar.final.q[3 * b], planar.final.q[3 * b + 1], 0)).norm() < 1e-9);
        }
      }
}

TEST_CASE(
    "anitescu-potra in space: a massé shot ends in rolling as angular momentum about the floor says, turned too") {
  const Vector3d roll(-0.102142857142857, 0.489857142857143, 0);
  State before;
  for (const Eigen::Quaterniond& R : {Eigen::Quaterniond::Identity(), kTurnedRelaxed}) {
    spatial::Scene s = masse();
    s.gravity = R * s.gravity;
    spatial::Body& ball = s.bodies[0];
    ball.position = R * ball.position, ball.velocity = R * ball.velocity, ball.omega = R * ball.omega;
    auto& floor = std::get<spatial::SpherePlane>(s.contacts[0]);
    floor.normal = R * floor.normal, floor.plane_point = R * floor.plane_point;
    const SpatialSystem system(s);
    const Run run = run_in_space(system, "anitescu-potra", 1e-3, 1);
    CHECK((R.inverse() * Vector3d(translation<Spatial>(run.final.v, 0)) - roll).norm() < 1e-9);
    const Vector3d x = R.inverse() * Vector3d(place_of<Spatial>(run.final.q, 0));
    if (before.q.size() > 0) CHECK((x - Vector3d(place_of<Spatial>(before.q, 0))).norm() < 1e-10);
    before = run.final;
  }
}

TEST_CASE(
    "anitescu-potra in space: contacts that do not slip yet turn with the scene: a ball that slides off another") {
  const auto balls = [](const Eigen::Quaterniond& R) {
    spatial::Scene s;
    s.gravity = R * Vector3d(0, 0, -9.81);
    const Vector3d up = Vector3d(0.3, 0.7, 1.5).normalized(), floor = R * Vector3d(0, 0, 1);
    const spatial::Matrix3d inertia = 0.004 * spatial::Matrix3d::Identity();
    const BodyId low = s.body({.inertia = inertia, .position = R * Vector3d(0, 0, 0.1)});
    const BodyId high = s.body({.inertia = inertia, .position = R * (Vector3d(0, 0, 0.1) + 0.2 * up)});
    s.contact(spatial::SpherePlane{"floor", low, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, floor, {.mu = 0.1}});
    s.contact(spatial::SphereSphere{"balls", high, {0, 0, 0}, 0.1, low, {0, 0, 0}, 0.1, {.mu = 0.1}});
    return s;
  };
  State before;
  for (const Eigen::Quaterniond& R : {Eigen::Quaterniond::Identity(), kTurnedRelaxed}) {
    const SpatialSystem system(balls(R));
    const Run run = run_in_space(system, "anitescu-potra", 1e-3, 0.1);
    for (Index b = 0; b < 2 && before.q.size() > 0; ++b)
      CHECK((R.inverse() * Vector3d(place_of<Spatial>(run.final.q, b)) - Vector3d(place_of<Spatial>(before.q, b)))
                .norm() < 1e-9);
    before = run.final;
  }
}

TEST_CASE("anitescu-potra in space refuses Poisson's law") {
  spatial::Scene s = masse();
  s.restitution = Restitution::poisson;
  const SpatialSystem system(s);
  CHECK_THROWS_WITH_AS(static_cast<void>(make_integrator("anitescu-potra", system)),
                       doctest::Contains("integrator anitescu-potra: restitution = \"poisson\": must be \"newton\""),
                       std::invalid_argument);
}
