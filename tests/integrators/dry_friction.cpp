// Dry friction in joints, and constraints that contradict each other.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/pendulum.h>

#include <cmath>
#include <numbers>

#include "experiments/support/fit_order.h"
#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

namespace orthant {

using testing::mismatch;

TEST_CASE("a flywheel with a dry brake stops when and where it must, and stays") {
  // J = 2, ω = 3, torque 0.5: stops after 12 s, at 18 rad.
  Scene s{.duration = 15};
  const auto wheel = s.body({.name = "wheel", .inertia = 2, .omega = 3});
  s.joint(Revolute{"axle", kGround, wheel});
  s.friction({"brake", Angle{kGround, wheel}, 0.5});
  for (const std::string scheme : {"moreau-jean", "moreau-jean:form=full", "stewart-trinkle", "anitescu-potra",
                                   "paoli-schatzman", "generalized-alpha", "rattle"})
    for (const std::string solver : {"lemke", "pgs", "path", "auto"}) {
      CAPTURE(scheme);
      CAPTURE(solver);
      double before = 0, at_12 = 0;
      const Run r = run(
          s, scheme, 0.01,
          [&](const RunSample& m) {
            if (m.state.t < 11.995) before = m.state.v[2];
            if (std::abs(m.state.t - 12.05) < 5e-3) at_12 = m.state.q[2];
          },
          solver);
      REQUIRE(r.status == Status::solved);
      CHECK(before == doctest::Approx(0.0025).epsilon(0.1));
      CHECK(std::abs(r.final.q[2] - 18) < 0.02);  // of first order at least
      CHECK(std::abs(r.final.v[2]) < 1e-12);
      CHECK(std::abs(r.final.q[2] - at_12) < 1e-12);  // stays
    }
}

TEST_CASE("dry friction holds a pendulum up to its bound, and no further") {
  const auto moved = [](double bound) {
    Scene s{.gravity = {0, -10}, .duration = 1};
    const auto rod = s.body({.name = "rod", .mass = 2, .inertia = 0.1, .position = {0.5, 0}});
    s.joint(Revolute{"pin", kGround, rod, {0, 0}, {-0.5, 0}});
    s.friction({"seal", Angle{kGround, rod}, bound});
    return run(s, "moreau-jean", 1e-3).final.q[2];
  };
  CHECK(std::abs(moved(10.001)) < 1e-12);  // m g l = 10
  CHECK(moved(9.9) < -1e-3);
}

TEST_CASE("friction of a joint's load: a wheel on its pin and a block on its rail slow down as their weights ask") {
  // The wheel bears 10 kg · 10 m/s² and a belt's pull across: 125 N on a pin of 2 cm; the block 2 kg.
  Scene s{.gravity = {0, -10}, .duration = 0.5};
  const auto wheel = s.body({.name = "wheel", .mass = 10, .inertia = 2, .omega = 3});
  const auto block = s.body({.name = "block", .mass = 2, .position = {0, 3}, .velocity = {4, 0}});
  s.joint(Revolute{"axle", kGround, wheel});
  s.joint(Prismatic{"rail", kGround, block, {0, 3}});
  s.load({.name = "belt", .body = wheel, .force = {75, 0}});
  s.friction({"bearing", Angle{kGround, wheel}, 0, 0.1, 0.02, 0});
  s.friction({"shoe", Slide{kGround, block, {0, 3}}, 1, 0.3, 1, 1});
  for (const std::string scheme : {"moreau-jean", "moreau-jean:form=full", "stewart-trinkle", "anitescu-potra"}) {
    CAPTURE(scheme);
    const double h = 1e-3;
    double angular = 0, linear = 0;
    const Run r = run(s, scheme, h, [&](const RunSample& m) { angular += m.frictions[0], linear += m.frictions[1]; });
    REQUIRE(r.status == Status::solved);
    const double torque = 0.1 * 0.02 * 125, force = 1 + 0.3 * 20;  // from the first step on
    CHECK(r.final.v[2] == doctest::Approx(3 - torque / 2 * 0.5).epsilon(1e-9));
    CHECK(r.final.v[3] == doctest::Approx(4 - force * 0.5 / 2).epsilon(1e-9));
    CHECK(angular == doctest::Approx(2 * (r.final.v[2] - 3)).epsilon(1e-9));
    CHECK(linear == doctest::Approx(2 * (r.final.v[3] - 4)).epsilon(1e-9));
  }
  for (const std::string scheme : {"generalized-alpha", "rattle"}) {
    const System system(s);
    CHECK_THROWS_WITH_AS(make_integrator(scheme, system),
                         doctest::Contains("friction \"bearing\" depends on the joint's load"), std::invalid_argument);
  }
  s.frictions[0].joint = 7;
  CHECK_THROWS_WITH_AS(check(s), doctest::Contains("friction \"bearing\": joint 7 has no load for mu"),
                       std::invalid_argument);
}

TEST_CASE(
    "friction of a joint's load holds a block on its steep rail from the first step on, above the friction angle") {
  const double slope = std::numbers::pi / 6;
  const auto slid = [&](double mu) {
    Scene s{.gravity = {0, -9.81}};
    const auto block = s.body({.name = "block", .mass = 3, .inertia = 0.1, .angle = slope});
    const Slide along{kGround, block, {0, 0}, {0, 0}, {std::cos(slope), std::sin(slope)}};
    s.joint(Prismatic{"rail", kGround, block, {0, 0}, {0, 0}, along.axis, slope});
    s.friction({"shoe", along, 0, mu, 1, 0});
    const Run r = run(s, "moreau-jean", 1e-3);
    REQUIRE(r.status == Status::solved);
    return std::hypot(r.final.q[0], r.final.q[1]);
  };
  CHECK(slid(1.001 * std::tan(slope)) < 1e-14);
  CHECK(slid(0.99 * std::tan(slope)) == doctest::Approx(0.01 * 9.81 / 2 * std::sin(slope)).epsilon(1e-3));  // ½ a t²
}

TEST_CASE("friction of a joint's load: the reduced and the full form agree, impacts within the step too") {
  for (const Impacts impacts : {Impacts::simultaneous, Impacts::sequential})
    for (const Restitution restitution : {Restitution::newton, Restitution::poisson}) {
      CAPTURE(impacts);
      CAPTURE(restitution);
      Scene s{.gravity = {0, -9.81}, .restitution = restitution, .impacts = impacts, .duration = 1};
      const auto arm = s.body({.name = "arm", .inertia = 0.1, .position = {0.5, 0}});
      s.joint(Revolute{"pivot", kGround, arm, {0, 0}, {-0.5, 0}});
      s.contact(Limit{"stop", Angle{kGround, arm}, Limit::Side::lower, -0.5, {.e = 0.5}});
      s.friction({"bearing", Angle{kGround, arm}, 0, 0.3, 0.05, 0});
      const Run reduced = run(s, "moreau-jean", 1e-3), full = run(s, "moreau-jean:form=full", 1e-3);
      REQUIRE(reduced.status == Status::solved);
      REQUIRE(full.status == Status::solved);
      CHECK(mismatch(reduced.final.v, full.final.v) < 1e-9);
      CHECK(mismatch(reduced.final.q, full.final.q) < 1e-9);
    }
}

TEST_CASE("friction of a joint's load does not depend on how often the joint is written, nor which way round") {
  Scene s{.gravity = {1, -10}, .duration = 0.2};
  const auto wheel = s.body({.name = "wheel", .mass = 10, .inertia = 2, .omega = 3});
  const auto block = s.body({.name = "block", .mass = 2, .position = {0.1, 3}, .velocity = {4, 0}});
  s.joint(Revolute{"axle", kGround, wheel, {0.1, 0}, {0.1, 0}});
  s.joint(Prismatic{"rail", kGround, block, {0, 3}});
  s.friction({"bearing", Angle{kGround, wheel}, 0, 0.1, 0.02, 0});
  s.friction({"shoe", Slide{kGround, block, {0, 3}}, 0, 0.3, 1, 1});
  s.bodies[0].velocity = {0, 0};
  Scene twice = s;
  twice.joint(Revolute{"axle_too", wheel, kGround, {0.1, 0}, {0.1, 0}});
  twice.joint(Prismatic{"rail_too", block, kGround, {0, 0}, {0, 3}});
  twice.joint(Prismatic{"rail_beside", kGround, block, {0, 3.5}, {-0.1, 0.5}, {-1, 0}});
  for (const std::string scheme : {"moreau-jean", "stewart-trinkle"}) {
    CAPTURE(scheme);
    const Run one = run(s, scheme, 1e-3), other = run(twice, scheme, 1e-3);
    CHECK((one.final.q - other.final.q).lpNorm<Eigen::Infinity>() < 1e-12);
    Scene smooth = s;
    smooth.frictions.clear();
    const Run free = run(smooth, scheme, 1e-3);
    CHECK(free.final.v[2] - one.final.v[2] > 1e-3);
    CHECK(free.final.v[3] - one.final.v[3] > 0.5);
  }
}

TEST_CASE("joints that contradict each other: no integrator calls that solved") {
  Scene s{.gravity = {0, -9.81}};
  const BodyId b = s.body({.name = "b", .position = {0.1, 0}});
  s.joint(Distance{"left", kGround, b, {0, 0}, {0, 0}, 1});
  s.joint(Distance{"right", kGround, b, {5, 0}, {0, 0}, 1});
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    const Run r = run_for(s, 0.01, scheme.name, 1e-3);
    CHECK(r.status == Status::numerical_error);
    CHECK(!r.why.empty());
  }
}

TEST_CASE("drives that contradict each other: unattainable rates are reported where positions may drift") {
  Scene s;
  const BodyId wheel = s.body({.name = "wheel"});
  s.joint(Revolute{"axle", kGround, wheel});
  s.joint(Drive{"slow", Angle{kGround, wheel}, {.rate_of_change = 1}});
  s.joint(Drive{"fast", Angle{kGround, wheel}, {.rate_of_change = 2}});
  for (const std::string form : {"reduced", "full"}) {
    CAPTURE(form);
    const Run r = run_for(s, 0.01, "moreau-jean:joints=none,form=" + form, 1e-3);
    CHECK(r.status != Status::solved);
    CHECK(r.why.find("joints") != std::string::npos);
  }
}

TEST_CASE(
    "joints that contradict each other by little: nothing that is not tied to them excuses it, nor a turned body") {
  for (const auto& [far, turned] : {std::pair(0.0, 0.0), {1e6, 0.0}, {2.0, 3e5}}) {
    Scene s{.gravity = {0, -9.81}};
    const BodyId b = s.body({.name = "b", .position = {1, 0}, .angle = turned});
    s.body({.name = "other", .position = {far, 3}, .angle = turned});
    s.joint(Distance{"one", kGround, b, {0, 0}, {0, 0}, 1});
    s.joint(Distance{"same", kGround, b, {0, 0}, {0, 0}, 1.004});
    for (const IntegratorEntry& scheme : integrators()) {
      CAPTURE(scheme.name);
      CAPTURE(far);
      CHECK(run_for(s, 0.01, scheme.name, 1e-3).status != Status::solved);
    }
  }
}

TEST_CASE("a drive that pushes a body through a floor: the contact that cannot be kept is named") {
  Scene s;
  const BodyId ram = s.body({.name = "ram", .position = {0, 0.5}, .velocity = {0, -1}});
  s.joint(Prismatic{"rail", kGround, ram, {0, 0}, {0, 0}, {0, 1}, 0});
  s.joint(Drive{"push", Slide{kGround, ram, {0, 0}, {0, 0}, {0, 1}}, {.offset = 0.5, .rate_of_change = -1}});
  s.contact(DiscWall{"side", ram, {0, 0}, 0.4, kGround, {-0.4, 0}, {1, 0}, {}});
  s.contact(DiscWall{"floor", ram, {0, 0}, 0.4, kGround, {0, 0}, {0, 1}, {}});
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    const Run r = run(s, scheme.name, 1e-2);
    CAPTURE(r.why);
    CHECK(r.status == Status::infeasible);
    CHECK(r.final.t < 0.12);
    CHECK(r.why == "jammed: drive \"push\", contact \"floor\" leave no motion; since t = 0.1");
  }
}

}  // namespace orthant
