// Mechanisms in space against published or computed solutions, redundant loops included.
#include "experiments/support/fit_order.h"
#include "tests/support/runs.h"
#include "tests/support/spatial.h"

#include <orthant/core/scenes/bennett.h>
#include <orthant/core/scenes/bricard.h>
#include <orthant/core/scenes/flyball.h>
#include <orthant/core/scenes/slider_crank_space.h>
#include <orthant/core/scenes/spatial_slider_crank.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

/// The value of joint `joint`'s angle at the end of a run, without jumps.
double angle_after(const SpatialSystem& system, std::size_t joint, std::string_view integrator, double h,
                   double duration, Run& run) {
  const spatial::Angle angle = std::get<spatial::Revolute>(system.scene().joints[joint]).angle();
  spatial::Unwrapped turns;
  double value = 0;
  run = run_in_space(system, integrator, h, duration, [&](const SpatialSample& m) {
    const auto k = poses_of(system, m.state);
    value = turns.add(m.state.t, angle.value(k), apply(angle.row(k), m.state.v.data()));
  });
  return value;
}

}  // namespace

TEST_CASE("the spatial slider-crank of the IFToMM library: order 2, and the published solution") {
  const SpatialSystem system(spatial_slider_crank());
  constexpr double kX1 = 0.21172166, kX5 = 0.24071957373, kTheta5 = 54.3333321683;
  for (const std::string_view form : {"moreau-jean", "moreau-jean:form=full"}) {
    CAPTURE(form);
    const auto error = [&](double h) {
      Run run;
      return std::abs(angle_after(system, 0, form, h, 5, run) - kTheta5);
    };
    const Fit fit = fit_order({.coarsest = 5e-4, .octaves = 3, .steps_per_octave = 2, .duration = 5}, error);
    MESSAGE(form << ": order " << fit.order << ", error " << fit.worst.back().error);
    CHECK(std::abs(fit.order - 2) < 0.25);
    CHECK(fit.worst.back().error < 2e-3);
  }
  const Run one = run_in_space(system, "moreau-jean", 2e-4, 1), five = run_in_space(system, "moreau-jean", 2e-4, 5);
  CHECK(std::abs(one.final.q[14] - kX1) < 2e-6);
  CHECK(std::abs(five.final.q[14] - kX5) < 5e-5);
  CHECK(five.max_joint_residual < 1e-14);
  SpatialSliderCrank thin;
  thin.rod_spin = 1e-10;
  const Run other = run_in_space(SpatialSystem(spatial_slider_crank(thin)), "moreau-jean", 2e-4, 1);
  CHECK(std::abs(other.final.q[14] - 0.208148583774) < 5e-6);
}

TEST_CASE(
    "the spatial slider-crank, its ball at the crank with clearance: tends to the published solution, in order 1") {
  constexpr double kX5 = 0.24071957373, kTheta5 = 54.3333321683;
  double x_off[2], angle_off[2];
  for (const bool fine : {false, true}) {
    SliderCrankClearance p;
    p.mu = 0, p.at_crank = 1, p.clearance = fine ? 1.5625e-5 : 6.25e-5;
    const SpatialSystem system(slider_crank_clearance(p));
    Run run;
    const double angle = angle_after(system, 0, "adaptive:rtol=1e-10", 0.05, 5, run);
    REQUIRE(run.status == Status::solved);
    x_off[fine] = std::abs(run.final.q[14] - kX5), angle_off[fine] = std::abs(angle - kTheta5);
  }
  MESSAGE("distances " << x_off[0] << ", " << x_off[1] << " m; " << angle_off[0] << ", " << angle_off[1] << " rad");
  CHECK(x_off[1] < 1e-3);
  CHECK(std::abs(std::log2(x_off[0] / x_off[1]) / 2 - 1) < 0.15);
  CHECK(std::abs(std::log2(angle_off[0] / angle_off[1]) / 2 - 1) < 0.15);
}

TEST_CASE("the spatial slider-crank in a channel: bound by its walls, and closing them gives the prismatic joint") {
  SliderCrankClearance p;
  p.mu = 0;
  const double ideal =
      run_in_space(SpatialSystem(slider_crank_clearance(p)), "adaptive:rtol=1e-9", 0.5, 0.5).final.q[14];
  double off[2];
  for (const bool fine : {false, true}) {
    p.guide = fine ? 1e-5 : 1e-3;
    const SpatialSystem system(slider_crank_clearance(p));
    CHECK(system.scene().joints.size() == 2);
    double highest = 0, widest = 0;
    const Run run = run_in_space(system, "adaptive:rtol=1e-9", 0.01, 0.5, [&](const SpatialSample& m) {
      highest = std::max(highest, std::abs(m.state.q[16])), widest = std::max(widest, std::abs(m.state.q[15]));
    });
    REQUIRE(run.status == Status::solved);
    CHECK(run.max_penetration < 1e-9);
    for (const double reach : {highest, widest}) {  // of the slider's centre: it rests on the walls
      CHECK(reach > 0.9 * p.guide);
      CHECK(reach < p.guide * (1 + 1e-6));
    }
    off[fine] = std::abs(run.final.q[14] - ideal);
  }
  CHECK(off[0] < 3e-3);
  CHECK(off[1] < 0.2 * off[0]);
}

TEST_CASE("Bricard's linkage: one row repeats others in every pose, and it runs to the published point") {
  const SpatialSystem system(bricard());
  CHECK(system.joint_rows() == 30);
  const State start = system.initial_state();
  TermsOf<Spatial> terms(system);
  set_poses(system, 0, start.q, terms.at);
  evaluate_joint_rows(system, terms);
  BasicSystemOf<Spatial> basic(system);
  REQUIRE(basic.factorize(system, terms));
  CHECK(basic.redundant());
  CHECK(basic.rank() == 29);
  CHECK(std::abs(energy(system, start) + 29.43) < 1e-13);
  const auto corner = [](const State& x) {  // (1, −1, 1) at first
    return Vector3d(Vector3d(place_of<Spatial>(x.q, 2)) +
                    quaternions::matrix_of(quaternion(x.q, 2)) * Vector3d(0, 0, 0.5));
  };
  double off = 0;  // (1 + sin a)(1 + sin b) = 1 of odd and even hinges
  const Run run = run_in_space(system, "moreau-jean", 1e-3, 10, [&](const SpatialSample& m) {
    const auto k = poses_of(system, m.state);
    const auto angle = [&](std::size_t i) {
      return std::get<spatial::Revolute>(system.scene().joints[i]).angle().value(k);
    };
    off = std::max(off, std::abs((1 + std::sin(angle(0))) * (1 + std::sin(angle(1))) - 1));
  });
  CHECK((corner(run.final) - Vector3d(0.9999999638, -1.0002690127, 0.9997309511)).norm() < 2e-7);
  CHECK(run.max_joint_residual < 1e-13);
  CHECK(std::abs(run.energy_final - run.energy_initial) < 1e-6);
  CHECK(off < 1e-12);
}

TEST_CASE("Bennett's linkage moves though its rows count it rigid, to the computed angle: order 2") {
  const SpatialSystem system(bennett());
  CHECK(system.dof() - system.joint_rows() == -2);
  Run run;
  const auto angle = [&](double h) { return angle_after(system, 0, "moreau-jean", h, 5, run); };
  const double fine = angle(2.5e-4);
  CHECK(std::abs(fine - 3.01649731398) < 1e-8);
  CHECK(run.max_joint_residual < 1e-13);
  // Rounding decides which of the rows that repeat others count: errors of neighbouring steps differ by half.
  const double order = std::log2((angle(2e-3) - 3.01649731398) / (angle(5e-4) - 3.01649731398)) / 2;
  MESSAGE("order " << order << ", error " << fine - 3.01649731398);
  CHECK(std::abs(order - 2) < 0.4);
}

TEST_CASE("the flyball governor on stiff springs: order 2") {
  const SpatialSystem system(flyball());
  Run run;
  const auto error = [&](double h) {
    run = run_in_space(system, "moreau-jean", h, 10);
    return std::abs(run.final.v[5] - 5.548203622655);
  };
  const Fit fit = fit_order({.coarsest = 4e-3, .octaves = 3, .steps_per_octave = 2, .duration = 10}, error);
  MESSAGE("order " << fit.order << ", error " << fit.worst.back().error);
  CHECK(std::abs(fit.order - 2) < 0.3);
  const auto k = poses_of(system, run.final);
  const double s = std::get<spatial::Prismatic>(system.scene().joints[1]).displacement().value(k);
  CHECK(std::abs(s - 0.619622917061) < 1e-5);
  for (const std::size_t hinge : {2UL, 3UL})
    CHECK(std::abs(std::get<spatial::Revolute>(system.scene().joints[hinge]).angle().value(k) - 0.390073701845) < 1e-5);
}

TEST_CASE("the planar slider-crank built in space and turned: the planar motion with all its impacts") {
  constexpr double kStep = 1e-5, kDuration = 0.05;
  const Run planar = run_for(slider_crank(), kDuration, "moreau-jean", kStep);
  REQUIRE(planar.status == Status::solved);
  REQUIRE(planar.lcp_solves > 500);
  for (const double turn : {0.0, 1.0})
    for (const double width : {0.0, 0.03})
      for (const std::string_view form : {"moreau-jean", "moreau-jean:form=full"}) {
        CAPTURE(turn);
        CAPTURE(width);
        CAPTURE(form);
        SliderCrankSpace p;
        p.turn_x = turn, p.turn_y = 0.5 * turn, p.turn_z = -0.7 * turn, p.width = width;
        const SpatialSystem system(slider_crank_space(p));
        Run spatial_run;
        const double shaft = angle_after(system, 0, form, kStep, kDuration, spatial_run);
        CHECK(std::abs(shaft - planar.final.q[2]) < 1e-10);
        const Eigen::Quaterniond R = Eigen::AngleAxisd(p.turn_z, Vector3d::UnitZ()) *
                                     Eigen::AngleAxisd(p.turn_y, Vector3d::UnitY()) *
                                     Eigen::AngleAxisd(p.turn_x, Vector3d::UnitX());
        for (Index b = 0; b < 3; ++b) {
          const Vector3d x = R.inverse() * Vector3d(place_of<Spatial>(spatial_run.final.q, b));
          CHECK((x - Vector3d(planar.final.q[3 * b], planar.final.q[3 * b + 1], 0)).norm() < 1e-10);
        }
        if (form == "moreau-jean") CHECK(spatial_run.lcp_solves == planar.lcp_solves);
        CHECK(std::abs(spatial_run.max_penetration - planar.max_penetration) < 1e-10);
      }
}

TEST_CASE("drives, springs, dry friction and limits along joint coordinates in space are those of the plane") {
  // A bar on a tilted pin, driven by a spring with damper, braked by dry friction, between stops; and its planar twin.
  Scene flat;
  flat.gravity = {0, -9.81};
  const auto bar = flat.body({.name = "bar", .mass = 2, .inertia = 0.3, .position = {0.5, 0}, .omega = 0});
  flat.joint(Revolute{"pin", kGround, bar, {0, 0}, {-0.5, 0}});
  flat.spring(JointSpring{"spring", Angle{kGround, bar}, 5, 0.3, 0.2});
  flat.friction({.name = "brake", .of = Angle{kGround, bar}, .bound = 0.4});
  flat.contact(Limit{"stop", Angle{kGround, bar}, Limit::Side::lower, -0.6, {.e = 0.5}});
  const Eigen::Quaterniond R(Eigen::AngleAxisd(0.8, Vector3d(1, 2, -1).normalized()));
  spatial::Scene s;
  s.gravity = R * Vector3d(0, -9.81, 0);
  const auto solid = s.body({.name = "bar",
                             .mass = 2,
                             .inertia = Vector3d(0.01, 0.3, 0.3).asDiagonal(),
                             .position = R * Vector3d(0.5, 0, 0),
                             .orientation = {R.w(), R.x(), R.y(), R.z()}});
  const Vector3d z = R * Vector3d::UnitZ(), x = R * Vector3d::UnitX();
  const spatial::Revolute pin{"pin", kGround, solid, {0, 0, 0}, {-0.5, 0, 0}, z, {0, 0, 1}, x, {1, 0, 0}};
  s.joint(pin);
  s.spring(spatial::JointSpring{"spring", pin.angle(), 5, 0.3, 0.2});
  s.friction({.name = "brake", .of = pin.angle(), .bound = 0.4});
  s.contact(spatial::Limit{"stop", pin.angle(), spatial::Limit::Side::lower, -0.6, {.e = 0.5}});
  const Run planar = run_for(flat, 2, "moreau-jean", 1e-3);
  const SpatialSystem system(s);
  Run solid_run;
  CHECK(std::abs(angle_after(system, 0, "moreau-jean", 1e-3, 2, solid_run) - planar.final.q[2]) < 1e-11);
  CHECK(std::abs(solid_run.energy_final - planar.energy_final) < 1e-10);
  CHECK(planar.lcp_solves > 100);
}

TEST_CASE("a driven joint in space follows its law over many turns") {
  spatial::Scene s;
  const auto rotor = s.body({.name = "rotor", .inertia = Vector3d(1, 2, 2.5).asDiagonal(), .omega = {5, 0, 0}});
  const spatial::Revolute shaft{"shaft", kGround, rotor, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  s.joint(shaft);
  s.joint(spatial::Drive{"motor", shaft.angle(), {.rate_of_change = 5, .amplitude = 0.3, .omega = 2}});
  s.bodies[0].omega = {5.6, 0, 0};
  const SpatialSystem system(s);
  Run run;
  const double angle = angle_after(system, 0, "moreau-jean", 1e-2, 10, run);
  CHECK(std::abs(angle - (50 + 0.3 * std::sin(20.0))) < 1e-12);
}
