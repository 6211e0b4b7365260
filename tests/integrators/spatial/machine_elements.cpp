// Motion with screws, gears, racks, pins in bushes and blocks in channels, against closed forms.
#include "experiments/support/fit_order.h"
#include "tests/support/spatial.h"

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
const Eigen::Quaterniond kAskew(Eigen::AngleAxisd(1.1, Vector3d(1, 2, -0.5).normalized()));
const Eigen::Vector4d kAskewTurn(kAskew.w(), kAskew.x(), kAskew.y(), kAskew.z());
const Vector3d kUp = kAskew * Vector3d::UnitZ();

/// A nut of 2 kg on a fixed screw along the turned z, which a spring holds.
spatial::Scene nut(double pitch, double stiffness, double gravity) {
  spatial::Scene s;
  s.gravity = -gravity * kUp;
  const auto b = s.body(
      {.name = "nut", .mass = 2, .inertia = Vector3d(0.01, 0.01, 0.004).asDiagonal(), .orientation = kAskewTurn});
  const spatial::Screw screw{.name = "screw",
                             .b = b,
                             .axis_a = kUp,
                             .reference_a = kAskew * Vector3d::UnitX(),
                             .reference_b = {1, 0, 0},
                             .pitch = pitch};
  s.joint(screw);
  if (stiffness > 0)
    s.spring(spatial::JointSpring{.name = "spring", .of = screw.displacement(), .stiffness = stiffness, .rest = 0.1});
  return s;
}

}  // namespace

TEST_CASE("a nut on a screw falls with its turning inertia through many turns, whatever the step") {
  const double pitch = 0.02, lead = pitch / kFullTurn, a = 9.81 / (1 + 0.004 / (lead * lead) / 2);
  const SpatialSystem system(nut(pitch, 0, 9.81));
  const auto& screw = std::get<spatial::Screw>(system.scene().joints[0]);
  for (const std::string_view scheme : {"moreau-jean", "moreau-jean:form=full", "rattle"}) {
    CAPTURE(scheme);
    spatial::Unwrapped turns;
    double angle = 0;
    const Run run = run_in_space(system, scheme, 1e-2, 10, [&](const SpatialSample& m) {
      const auto k = poses_of(system, m.state);
      angle = turns.add(m.state.t, screw.angle().value(k), apply(screw.angle().row(k), m.state.v.data()));
    });
    const double s = screw.displacement().value(poses_of(system, run.final));
    CHECK(std::abs(s + a * 50) < 1e-9);
    CHECK(std::abs(angle - s / lead) < 1e-8);
    CHECK(angle < -5 * kFullTurn);
    CHECK(run.max_joint_residual < 1e-12);
  }
}

TEST_CASE("a nut on a screw and a spring swings at its frequency: order 2") {
  const double pitch = 0.1, lead = pitch / kFullTurn, k = 3000, w = std::sqrt(k / (2 + 0.004 / (lead * lead)));
  const SpatialSystem system(nut(pitch, k, 0));
  const auto& screw = std::get<spatial::Screw>(system.scene().joints[0]);
  for (const std::string_view scheme : {"moreau-jean", "rattle"}) {
    CAPTURE(scheme);
    const Fit fit = fit_order({.coarsest = 4e-3, .octaves = 4, .steps_per_octave = 3, .duration = 1}, [&](double h) {
      const Run run = run_in_space(system, scheme, h, 1);
      return std::abs(screw.displacement().value(poses_of(system, run.final)) - 0.1 * (1 - std::cos(w)));
    });
    MESSAGE(scheme << ": order " << fit.order << ", error " << fit.worst.back().error);
    CHECK(std::abs(fit.order - 2) < 0.1);
    CHECK(fit.worst.back().error < 1e-5);
  }
}

TEST_CASE("gears on oblique axes, and a rack under a weight, accelerate as one inertia") {
  // 20 teeth on 60, axes square to each other; a moment of 3 N m on the first: α = M / (J₁ + J₂/9).
  spatial::Scene s;
  const Vector3d other = kAskew * Vector3d::UnitX();
  const auto wheel = [&](const char* name, double J, const Vector3d& axis) {
    const auto b = s.body({.name = name, .inertia = Vector3d(J, J, J).asDiagonal(), .orientation = kAskewTurn});
    const spatial::Revolute shaft{name,
                                  kGround,
                                  b,
                                  {0, 0, 0},
                                  {0, 0, 0},
                                  axis,
                                  kAskew.inverse() * axis,
                                  spatial::perpendicular(axis),
                                  kAskew.inverse() * spatial::perpendicular(axis)};
    s.joint(shaft);
    return shaft.angle();
  };
  const spatial::Angle one = wheel("pinion", 0.02, kUp), two = wheel("wheel", 0.45, other);
  s.joint(spatial::Gear("gears", one, two, -20.0 / 60));
  s.load({.name = "motor", .body = 0, .moment = 3 * kUp});
  const SpatialSystem system(s);
  for (const std::string_view scheme : {"moreau-jean", "moreau-jean:form=full", "generalized-alpha", "rattle"}) {
    CAPTURE(scheme);
    const Run run = run_in_space(system, scheme, 1e-3, 1);  // 21 turns of the pinion a second at the end
    const double alpha = 3 / (0.02 + 0.45 / 9);
    CHECK((world_omega(system, run.final, 0) - alpha * kUp).norm() < 1e-8);
    CHECK((world_omega(system, run.final, 1) + alpha / 3 * other).norm() < 1e-8);
    CHECK(run.max_joint_residual < 1e-12);
  }
  // A rack of 3 kg falls and turns a pinion of the radius 0.2 m: a = m g / (m + J / r²).
  spatial::Scene r;
  r.gravity = -9.81 * kUp;
  const auto pinion =
      r.body({.name = "pinion", .inertia = Vector3d(0.02, 0.015, 0.015).asDiagonal(), .orientation = kAskewTurn});
  const auto bar = r.body({.name = "bar", .mass = 3, .orientation = kAskewTurn});
  const Vector3d axis = kAskew * Vector3d::UnitX();
  const spatial::Revolute shaft{"shaft", kGround, pinion, {0, 0, 0}, {0, 0, 0}, axis, {1, 0, 0}};
  const spatial::Prismatic rail{"rail", kGround, bar, {0, 0, 0}, {0, 0, 0}, kUp, kAskewTurn};
  r.joint(shaft), r.joint(rail);
  spatial::Gear rack("rack", shaft.angle(), rail.displacement(), 0.2);
  rack.offset = rack.value(poses_of(SpatialSystem(r), SpatialSystem(r).initial_state()));
  r.joint(rack);
  const SpatialSystem falls(r);
  const Run run = run_in_space(falls, "moreau-jean", 1e-3, 2);
  const double a = 3 * 9.81 / (3 + 0.02 / 0.04);
  CHECK((Vector3d(place_of<Spatial>(run.final.q, 1)) + 2 * a * kUp).norm() < 1e-9);
  CHECK((world_omega(falls, run.final, 0) + 2 * a / 0.2 * axis).norm() < 1e-9);
}

TEST_CASE("a pin in a bush without friction swings sideways as a pendulum of the length of the clearance") {
  // Both rims in contact: the pin stays parallel, its centre moves on a circle of the clearance. ω² = g / c.
  const double play = 0.1, tilt = 0.05;
  for (const bool of_pin : {true, false}) {
    CAPTURE(of_pin);
    spatial::Scene s;
    s.gravity = kAskew * Vector3d(0, 0, -9.81);
    const auto pin = s.body({.name = "pin",
                             .inertia = Vector3d(0.1, 0.1, 0.1).asDiagonal(),
                             .position = kAskew * Vector3d(0, play * std::sin(tilt), -play * std::cos(tilt)),
                             .orientation = kAskewTurn});
    s.contact_set(spatial::pin_in_bush({.name = "bearing",
                                        .a = pin,
                                        .axis_a = {1, 0, 0},
                                        .radius_a = 0.4,
                                        .axis_b = kAskew * Vector3d::UnitX(),
                                        .radius_b = 0.5,
                                        .rim_of_pin = of_pin},
                                       0.6));
    const SpatialSystem system(s);
    const double period = kFullTurn * std::sqrt(play / 9.81) * (1 + tilt * tilt / 16);
    const Run run = run_in_space(system, "moreau-jean", period / 4000, period);
    const Vector3d x = kAskew.inverse() * Vector3d(place_of<Spatial>(run.final.q, 0));
    CHECK(std::abs(x.y() - play * std::sin(tilt)) < 2e-5 * play);
    CHECK(std::abs(x.x()) < 1e-9);
    CHECK(run.max_penetration < 1e-6);
    CHECK(run.lcp_solves > 3000);
  }
}

TEST_CASE("a shaft that tips in its bush rests on both rims at the angle of its clearance") {
  // Weight at one end: the pin tips until its rims touch, one above and one below: sin θ = 2 c / L to first order; on
  // the way the rims meet the bush at their highest and lowest points: L sin θ + 2 r cos θ = 2 R.
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  const double r = 0.1, R = 0.102, L = 0.5;
  const auto pin = s.body({.name = "pin", .inertia = Vector3d(0.01, 0.03, 0.03).asDiagonal(), .position = {0, 0, 0}});
  s.contact_set(spatial::pin_in_bush({.name = "bearing",
                                      .a = pin,
                                      .axis_a = {1, 0, 0},
                                      .radius_a = r,
                                      .axis_b = {1, 0, 0},
                                      .radius_b = R,
                                      .law = {.mu = 0.5}},
                                     L));
  s.load({.name = "weight", .body = pin, .point = {0.6, 0, 0}, .force = {0, 0, -20}, .frame = spatial::Frame::world});
  const SpatialSystem system(s);
  const Run run = run_in_space(system, "stewart-trinkle", 1e-4, 1);
  double theta = 2 * (R - r) / L;
  for (int i = 0; i < 20; ++i) theta = std::asin((2 * R - 2 * r * std::cos(theta)) / L);
  const Vector3d shaft = poses_of(system, run.final).at(0).R.col(0);
  CHECK(std::abs(-std::asin(shaft.z()) - theta) < 1e-6);
  CHECK(run.final.v.lpNorm<Eigen::Infinity>() < 1e-6);
  CHECK(run.max_penetration < 1e-4);
}

TEST_CASE("a block in a channel: it slides along it with the friction of its floor, and rests at its clearance") {
  // v = 2 m/s along the channel, μ = 0.3: it stops after v²/2μg.
  spatial::Scene s;
  s.gravity = kAskew * Vector3d(0, 0, -10);
  const auto block = s.body({.name = "block",
                             .inertia = Vector3d(0.01, 0.02, 0.02).asDiagonal(),
                             .position = kAskew * Vector3d(0, 0, -0.001),
                             .orientation = kAskewTurn,
                             .velocity = kAskew * Vector3d(2, 0, 0)});
  s.contact_set(spatial::block_in_channel({.name = "guide",
                                           .a = block,
                                           .size = {0.3, 0.2, 0.1},
                                           .axis = kAskew * Vector3d::UnitX(),
                                           .up = kUp,
                                           .width = 0.202,
                                           .height = 0.102,
                                           .law = {.mu = 0.3}}));
  const SpatialSystem system(s);
  CHECK(system.contacts() == 16);
  const Run run = run_in_space(system, "moreau-jean", 1e-3, 1);
  const Vector3d x = kAskew.inverse() * Vector3d(place_of<Spatial>(run.final.q, 0));
  CHECK((x - Vector3d(4.0 / 6, 0, -0.001)).norm() < 2e-6);
  CHECK(run.final.v.lpNorm<Eigen::Infinity>() < 1e-9);
}
