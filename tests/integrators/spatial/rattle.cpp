// RATTLE in space: what it keeps exactly, its order against closed forms and published solutions, the plane in space.
#include "experiments/support/fit_order.h"
#include "tests/support/runs.h"
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/bricard.h>
#include <orthant/core/scenes/masse.h>
#include <orthant/core/scenes/slider_crank_space.h>
#include <orthant/core/scenes/spatial_slider_crank.h>
#include <orthant/core/scenes/top.h>

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

TEST_CASE(
    "rattle in space: a free asymmetric body keeps its angular momentum, its energy swings with the step squared") {
  const SpatialSystem system(tumbling());
  const State start = system.initial_state();
  const Vector3d L = angular_momentum(system, start);
  const auto swing = [&](double h, double duration) {
    double energy_off = 0, momentum_off = 0, unit_off = 0, flipped = 1;
    run_in_space(system, "rattle", h, duration, [&](const SpatialSample& m) {
      energy_off = std::max(energy_off, std::abs(energy(system, m.state) / energy(system, start) - 1));
      momentum_off = std::max(momentum_off, (angular_momentum(system, m.state) - L).norm() / L.norm());
      unit_off = std::max(unit_off, std::abs(quaternion(m.state.q, 0).norm() - 1));
      flipped = std::min(flipped, m.state.v[4] / start.v[4]);
    });
    CHECK(momentum_off < 1e-11);
    CHECK(unit_off < 1e-15);
    CHECK(flipped < -0.9);
    return energy_off;
  };
  const double coarse = swing(0.02, 50), fine = swing(0.01, 50), longer = swing(0.01, 500);
  MESSAGE("energy swings by " << coarse << ", " << fine << "; ten times as long by " << longer);
  CHECK(std::abs(std::log2(coarse / fine) - 2) < 0.1);
  CHECK(std::abs(longer / fine - 1) < 0.05);
}

TEST_CASE("rattle in space: order 2 of a free asymmetric body's orientation") {
  const SpatialSystem system(tumbling());
  const Run exact = run_in_space(system, "moreau-jean", 1e-4, 4);
  const Fit fit = fit_order({.coarsest = 0.05, .octaves = 4, .steps_per_octave = 4, .duration = 4}, [&](double h) {
    const Run run = run_in_space(system, "rattle", h, 4);
    return quaternions::turn_between(quaternion(exact.final.q, 0), quaternion(run.final.q, 0)).norm();
  });
  MESSAGE("order " << fit.order << ", scatter " << fit.scatter << ", error " << fit.worst.back().error);
  CHECK(std::abs(fit.order - 2) < 0.1);
  CHECK(fit.scatter < 0.1);
}

TEST_CASE("rattle in space: nutation and precession of Lagrange's top, order 2") {
  const SpatialSystem system(top());
  constexpr double kPeriod = 0.10996771481, kLargest = 31.68007640528, kPrecession = 0.18417249693;
  double largest = 0, precession = 0;
  const Fit fit =
      fit_order({.coarsest = 4e-4, .octaves = 4, .steps_per_octave = 3, .duration = kPeriod}, [&](double h) {
        largest = 0;
        const Run run = run_in_space(system, "rattle", h, kPeriod, [&](const SpatialSample& m) {
          const Vector3d axis = quaternions::matrix_of(quaternion(m.state.q, 0)).col(2);
          largest = std::max(largest, std::acos(axis.z()) * 180 / std::numbers::pi);
          precession = std::atan2(axis.y(), axis.x());
        });
        CHECK(run.max_joint_residual < 1e-13);
        return std::abs(precession - kPrecession);
      });
  MESSAGE("order " << fit.order << ", scatter " << fit.scatter << ", error " << fit.worst.back().error);
  CHECK(std::abs(fit.order - 2) < 0.1);
  CHECK(fit.worst.back().error < 1e-5);
  CHECK(std::abs(largest - kLargest) < 2e-4);
}

TEST_CASE("rattle in space: the spatial slider-crank of the IFToMM library, order 2") {
  const SpatialSystem system(spatial_slider_crank());
  constexpr double kX1 = 0.21172166;
  double joints = 0;
  const Fit fit = fit_order({.coarsest = 4e-3, .octaves = 4, .steps_per_octave = 2, .duration = 1}, [&](double h) {
    const Run run = run_in_space(system, "rattle", h, 1);
    joints = std::max(joints, run.max_joint_residual);
    return std::abs(run.final.q[14] - kX1);
  });
  MESSAGE("order " << fit.order << ", scatter " << fit.scatter << ", error " << fit.worst.back().error);
  CHECK(std::abs(fit.order - 2) < 0.15);
  CHECK(fit.worst.back().error < 1e-5);
  CHECK(joints < 1e-12);
}

TEST_CASE("rattle in space: Bricard's linkage, one redundant row in every pose, to the published point") {
  const SpatialSystem system(bricard());
  const Run run = run_in_space(system, "rattle", 1e-3, 10);
  const Vector3d corner = Vector3d(place_of<Spatial>(run.final.q, 2)) +
                          quaternions::matrix_of(quaternion(run.final.q, 2)) * Vector3d(0, 0, 0.5);
  CHECK((corner - Vector3d(0.9999999638, -1.0002690127, 0.9997309511)).norm() < 2e-6);
  CHECK(run.max_joint_residual < 1e-12);
  CHECK(std::abs(run.energy_final - run.energy_initial) < 1e-4);
}

TEST_CASE(
    "rattle in space: the planar slider-crank built in space and turned has the planar motion with all its impacts") {
  constexpr double kStep = 1e-5, kDuration = 0.02;
  const Run planar = run_for(slider_crank(), kDuration, "rattle", kStep);
  REQUIRE(planar.status == Status::solved);
  REQUIRE(planar.lcp_solves > 50);
  for (const double turn : {0.0, 1.0})
    for (const double width : {0.0, 0.03}) {
      CAPTURE(turn);
      CAPTURE(width);
      SliderCrankSpace p;
      p.turn_x = turn, p.turn_y = 0.5 * turn, p.turn_z = -0.7 * turn, p.width = width;
      const SpatialSystem system(slider_crank_space(p));
      const Run run = run_in_space(system, "rattle", kStep, kDuration);
      const Eigen::Quaterniond R = Eigen::AngleAxisd(p.turn_z, Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(p.turn_y, Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(p.turn_x, Vector3d::UnitX());
      for (Index b = 0; b < 3; ++b) {
        const Vector3d x = R.inverse() * Vector3d(place_of<Spatial>(run.final.q, b));
        CHECK((x - Vector3d(planar.final.q[3 * b], planar.final.q[3 * b + 1], 0)).norm() < 1e-9);
      }
      CHECK(std::abs(run.max_penetration - planar.max_penetration) < 1e-10);
      CHECK(run.max_joint_residual < 1e-12);
    }
}

TEST_CASE("rattle in space: impact of a superball that slips, and a massé shot") {
  for (const double h : {1e-2, 1e-3}) {
    CAPTURE(h);
    spatial::Scene s;
    const auto ball = s.body({.name = "ball",
                              .mass = 2,
                              .inertia = Vector3d::Constant(0.4 * 2 * 0.01).asDiagonal(),
                              .position = {0, 0, 0.15},
                              .velocity = {2, 1, -3},
                              .omega = {10, -20, 5}});
    s.contact(
        spatial::SpherePlane{"floor", ball, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = 0.1, .e = 0.5}});
    const SpatialSystem system(s);
    const Run run = run_in_space(system, "rattle", h, 0.1);
    CHECK((Vector3d(translation<Spatial>(run.final.v, 0)) - Vector3d(1.597507764050, 0.798753882025, 1.5)).norm() <
          1e-10);
    CHECK((world_omega(system, run.final, 0) - Vector3d(4.968847050625, -9.937694101251, 5)).norm() < 1e-9);
    CHECK(run.max_penetration < 1e-12);
  }
  const SpatialSystem system(masse());
  const Vector3d roll(-0.102142857142857, 0.489857142857143, 0);
  const Vector3d exact = Vector3d(0.275969961, 0.150564996, 0.028575) + (1 - 0.6147302241381) * roll;
  const auto error = [&](double h) {
    const Run run = run_in_space(system, "rattle", h, 1);
    CHECK((Vector3d(translation<Spatial>(run.final.v, 0)) - roll).norm() < 1e-10);
    CHECK(run.max_penetration < 1e-12);
    return (Vector3d(place_of<Spatial>(run.final.q, 0)) - exact).norm();
  };
  MESSAGE("errors " << error(1e-2) << ", " << error(1e-3));
  CHECK(error(1e-3) < 1e-6);
}

TEST_CASE("rattle in space: a scene turned, moved and boosted has the same motion") {
  // An asymmetric body on a spherical joint of a sled, which slides on one sphere over a floor with friction.
  const auto scene = [](const Eigen::Quaterniond& R, const Vector3d& moved) {
    spatial::Scene s;
    s.gravity = R * Vector3d(0, 0, -9.81);
    const auto world = [&](const Vector3d& x) { return Vector3d(R * x + moved); };
    const Eigen::Vector4d turn(R.w(), R.x(), R.y(), R.z());
    const auto sled = s.body({.name = "sled",
                              .mass = 3,
                              .inertia = Vector3d(0.02, 0.03, 0.04).asDiagonal(),
                              .position = world({0, 0, 0.1}),
                              .orientation = turn,
                              .velocity = R * Vector3d(1, 0.4, 0),
                              .omega = R * Vector3d(0.3, -0.2, 2)});
    const auto arm = s.body({.name = "arm",
                             .inertia = Vector3d(0.01, 0.05, 0.055).asDiagonal(),
                             .position = world({0.4, 0, 0.1}),
                             .orientation = turn,
                             .velocity = R * Vector3d(1, 0.4, 0),
                             .omega = R * Vector3d(4, 1, 0.5)});
    s.joint(spatial::Spherical{"ball", sled, arm, {0.1, 0, 0}, {-0.3, 0, 0}});
    s.contact(spatial::SpherePlane{
        "floor", sled, {0, 0, 0}, 0.1, kGround, moved, R * Vector3d(0, 0, 1), {.mu = 0.3, .e = 0.2}});
    return s;
  };
  const Eigen::Quaterniond R(Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.5).normalized()));
  const Vector3d moved(0.3, -0.2, 0.5);
  const SpatialSystem one(scene(Eigen::Quaterniond::Identity(), {0, 0, 0})), other(scene(R, moved));
  const Run a = run_in_space(one, "rattle", 1e-3, 0.5), b = run_in_space(other, "rattle", 1e-3, 0.5);
  REQUIRE(a.lcp_solves > 100);
  for (Index i = 0; i < 2; ++i) {
    CHECK((R * Vector3d(place_of<Spatial>(a.final.q, i)) + moved - Vector3d(place_of<Spatial>(b.final.q, i))).norm() <
          1e-10);
    CHECK((R * Vector3d(translation<Spatial>(a.final.v, i)) - Vector3d(translation<Spatial>(b.final.v, i))).norm() <
          1e-9);
  }
}

TEST_CASE("rattle in space: dry friction in a joint stops a rotor where it should") {
  // J ω̇ = −M: from ω it stops after J ω² / 2 M.
  spatial::Scene s;
  const auto rotor = s.body({.name = "rotor", .inertia = Vector3d(1, 2, 2.5).asDiagonal(), .omega = {0, 0, 3}});
  const spatial::Revolute shaft{"shaft", kGround, rotor, {0, 0, 0}, {0, 0, 0}};
  s.joint(shaft);
  s.friction({.name = "brake", .of = shaft.angle(), .bound = 7.5});
  const SpatialSystem system(s);
  const Run run = run_in_space(system, "rattle", 1e-3, 2);
  CHECK(std::abs(shaft.angle().value(poses_of(system, run.final)) - 1.5) < 1e-6);
  CHECK(std::abs(run.final.v[5]) < 1e-10);
}

TEST_CASE("rattle in space: laws that it does not take, and steps that are much too long, are refused in words") {
  spatial::Scene s = masse();
  s.impacts = Impacts::sequential;
  const SpatialSystem sequential(s);
  CHECK_THROWS_WITH_AS(static_cast<void>(make_integrator("rattle", sequential)),
                       doctest::Contains("integrator rattle: impacts = \"sequential\": must be \"simultaneous\""),
                       std::invalid_argument);
  const SpatialSystem system(tumbling());
  const auto scheme = make_integrator("rattle", system);
  const auto solver = make_solver("auto");
  State x = system.initial_state();
  const Eigen::VectorXd before = x.q;
  const StepReport report = scheme->step(2, *solver, x);
  CHECK(report.status == Status::numerical_error);
  CHECK(scheme->why() == "bodies turn too far in a step for their gyroscopic moments: a shorter step converges");
  CHECK(x.q == before);
}

TEST_CASE("a ball rolls over the seams of planks as on one tile: rattle and generalized-alpha") {
  const auto final_of = [](std::string_view scheme, int planks) {
    spatial::Scene s;
    s.gravity = {0, 0, -9.81};
    const spatial::Solid ball = spatial::sphere(0.1);
    s.body({.inertia = ball.inertia, .position = {-0.4, 0.1, 0.1}, .velocity = {2, 0.3, 0}});
    spatial::Collision c{.name = "floor", .shapes = {{0, {{0, 0, 0}}, 0.1}}, .law = {.mu = 0.3}};
    for (int i = 0; i < planks; ++i) {
      spatial::Shape plank{kGround, spatial::box_corners({2.0 / planks, 2, 0.5}), 0};
      for (Vector3d& p : plank.corners) p += Vector3d(-2 + (2 * i + 1) * 2.0 / planks, 0, -0.5);
      c.shapes.push_back(plank);
    }
    s.collision(c);
    return run_in_space(SpatialSystem(s), scheme, 1e-3, 0.5).final;
  };
  for (const std::string_view scheme : {"rattle", "generalized-alpha"}) {
    CAPTURE(scheme);
    const State one = final_of(scheme, 1), many = final_of(scheme, 40);
    CHECK((one.v - many.v).lpNorm<Eigen::Infinity>() < 1e-10);
    CHECK((one.q - many.q).lpNorm<Eigen::Infinity>() < 1e-10);
  }
}

TEST_CASE("rattle in space: a scene turned, moved and seen from a train has the same motion") {
  const auto final_of = [](const Eigen::Vector4d& turn, const Vector3d& shift, const Vector3d& train) {
    const Eigen::Matrix3d R = quaternions::matrix_of(turn);
    spatial::Scene s;
    const Eigen::Matrix3d J = Vector3d(0.02, 0.03, 0.04).asDiagonal();
    const auto add = [&](const Vector3d& x, const Vector3d& v, const Vector3d& omega) {
      s.body({.mass = 1.5,
              .inertia = J,
              .position = R * x + shift,
              .orientation = turn,
              .velocity = R * v + train,
              .omega = R * omega});
    };
    add({0, 0, 0}, {0.3, 0.1, 0}, {1, 2, 3}), add({0.5, 0.02, 0.1}, {-0.9, 0.1, -0.1}, {2, -1, 0.5});
    add({0.02, 0.6, 0.1}, {0.1, -1, 0}, {0, 1, 0});
    s.spring(spatial::PointSpring{.a = 0, .b = 1, .stiffness = 50, .damping = 1, .rest = 0.4});
    s.collision(
        {.name = "all",
         .shapes = {{0, {{0, 0, 0}}, 0.15}, {1, {{0, 0, 0}}, 0.15}, {2, spatial::box_corners({0.15, 0.15, 0.15}), 0}},
         .law = {.mu = 0.3, .e = 0.5}});
    return run_in_space(SpatialSystem(s), "rattle", 1e-3, 0.5).final;
  };
  const Eigen::Vector4d none(1, 0, 0, 0), turn = Eigen::Vector4d(0.4, -0.5, 0.7, 0.2).normalized();
  const Vector3d zero(0, 0, 0), shift(3, -2, 1.5), train(1, 2, -1.5);
  const State base = final_of(none, zero, zero);
  const Eigen::Matrix3d R = quaternions::matrix_of(turn);
  const State turned = final_of(turn, zero, zero), moved = final_of(none, shift, train);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3d x = base.q.segment<3>(7 * i), v = base.v.segment<3>(6 * i);
    CHECK((turned.q.segment<3>(7 * i) - R * x).norm() < 1e-10);
    CHECK((turned.v.segment<3>(6 * i) - R * v).norm() < 1e-10);
    CHECK((moved.q.segment<3>(7 * i) - x - shift - 0.5 * train).norm() < 1e-10);
    CHECK((moved.v.segment<3>(6 * i) - v - train).norm() < 1e-10);
    CHECK((moved.v.segment<3>(6 * i + 3) - base.v.segment<3>(6 * i + 3)).norm() < 1e-10);
  }
}
