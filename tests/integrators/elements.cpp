// Driven joints, limits, ropes, clearance joints, dry friction in joints: exact answers, every integrator.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/pendulum.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "experiments/support/fit_order.h"
#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

namespace orthant {
namespace {

using testing::mismatch;

const std::string kEveryScheme[] = {"moreau-jean",       "stewart-trinkle", "anitescu-potra", "paoli-schatzman",
                                    "generalized-alpha", "rattle",          "event-driven",   "adaptive"};
const std::string kSecondOrder[] = {"moreau-jean", "generalized-alpha", "rattle"};
const std::string kLocating[] = {"event-driven:rtol=1e-10,atol=1e-12", "adaptive:rtol=1e-8,atol=1e-10"};

/// A crank turned by a motor, rod and slider: every position is a formula of the crank's angle.
Scene driven_crank(const TimeLaw& law) {
  Scene s = slider_crank_ideal();
  s.joint(Drive{"motor", Angle{kGround, 0}, law});
  s.duration = 0.1;
  const double angle = law.value(0), rate = law.rate(0);
  // Started stretched out: only rates are set.
  REQUIRE(angle == 0);
  const double ratio = rate / s.bodies[0].omega;
  for (Body& body : s.bodies) body.velocity *= ratio, body.omega *= ratio;
  return s;
}
double slider_at(double theta) {
  const SliderCrank p;
  const double height = p.l1 * std::sin(theta);
  return p.l1 * std::cos(theta) + std::sqrt(p.l2 * p.l2 - height * height);
}

/// A bead on a bar that turns at the rate ω from r = 1 at rest against the bar: r = cosh ωt.
Scene bead(double omega) {
  Scene s{.duration = 1};
  const auto bar = s.body({.name = "bar", .mass = 2, .inertia = 3, .omega = omega});
  const auto bead = s.body(
      {.name = "bead", .mass = 0.5, .inertia = 0.01, .position = {1, 0}, .velocity = {0, omega}, .omega = omega});
  s.joint(Revolute{"pivot", kGround, bar}), s.joint(Prismatic{"rail", bar, bead});
  s.joint(Drive{"motor", Angle{kGround, bar}, {.rate_of_change = omega}});
  return s;
}

/// A cart moved by A sin Ωt with a mass on a spring along it: relative to the cart, ü + ω² u = A Ω² sin Ωt.
struct Shaken {
  double A = 0.3, W = 5, w = 3;
  Scene scene() const {
    Scene s{.duration = 2};
    const auto cart = s.body({.name = "cart", .velocity = {A * W, 0}}),
               block = s.body({.name = "block", .mass = 2, .velocity = {A * W, 0}});
    s.joint(Prismatic{"track", kGround, cart}), s.joint(Prismatic{"rail", cart, block});
    s.joint(Drive{"shaker", Slide{kGround, cart}, {.amplitude = A, .omega = W}});
    s.spring(JointSpring{"coil", Slide{cart, block}, 2 * w * w});
    return s;
  }
  double u(double t) const {  // u(0) = u̇(0) = 0
    const double amplitude = A * W * W / (w * w - W * W);
    return amplitude * (std::sin(W * t) - W / w * std::sin(w * t));
  }
};

double worst_rate(const Run& r) { return r.max_joint_rate; }

}  // namespace

TEST_CASE("a driven slider-crank follows the drive, at constant and at varying speed") {
  const TimeLaw laws[] = {{.rate_of_change = 40},
                          {.rate_of_change = 40, .amplitude = 0.4, .omega = 60},
                          {.table = Spline({0, 0.03, 0.06, 0.1}, {0, 2, 1, 3})}};
  for (const TimeLaw& law : laws)
    for (const std::string& scheme : kEveryScheme) {
      CAPTURE(scheme);
      double off = 0;
      const Run r = run(driven_crank(law), scheme, 5e-4, [&](const RunSample& m) {
        const double theta = law.value(m.state.t);
        off = std::max({off, 1e-3 * std::abs(m.state.v[2] - law.rate(m.state.t)), std::abs(m.state.q[2] - theta),
                        std::abs(m.state.q[6] - slider_at(theta))});
      });
      CHECK(r.status == Status::solved);
      const bool between = scheme == "adaptive";  // states between inner steps keep joints to the tolerance, 1e-6
      CHECK(off < (between ? 1e-8 : 1e-12));
      CHECK(r.max_joint_residual < (between ? 1e-8 : 1e-12));
      CHECK(worst_rate(r) < (between ? 1e-5 : 1e-11));
    }
}

TEST_CASE("a bead runs out on a bar turned at constant speed as cosh: errors of second order, small where controlled") {
  const auto error = [](const std::string& scheme, double h) {
    const Run r = run(bead(2), scheme, h);
    REQUIRE(r.status == Status::solved);
    return std::abs(r.final.q.segment<2>(3).norm() - std::cosh(2.0));
  };
  for (const std::string& scheme : kSecondOrder) {
    CAPTURE(scheme);
    CHECK(std::log2(error(scheme, 0.02) / error(scheme, 0.01)) == doctest::Approx(2).epsilon(0.05));
  }
  CHECK(error(kLocating[0], 0.1) < 1e-8);
  CHECK(error(kLocating[1], 0.1) < 1e-6);
}

TEST_CASE("a spring on a shaken cart: driven slide, forced vibration, second order") {
  const Shaken shaken;
  const auto error = [&](const std::string& scheme, double h) {
    double worst = 0;
    const Run r = run(shaken.scene(), scheme, h, [&](const RunSample& m) {
      worst = std::max(worst, std::abs(m.state.q[3] - m.state.q[0] - shaken.u(m.state.t)));
    });
    REQUIRE(r.status == Status::solved);
    CHECK(r.max_joint_residual < (scheme.starts_with("adaptive") ? 1e-9 : 1e-13));
    return worst;
  };
  for (const std::string& scheme : kSecondOrder) {
    CAPTURE(scheme);
    CHECK(std::log2(error(scheme, 0.02) / error(scheme, 0.01)) == doctest::Approx(2).epsilon(0.05));
  }
  CHECK(error(kLocating[0], 0.1) < 1e-8);
  CHECK(error(kLocating[1], 0.1) < 1e-6);
}

TEST_CASE("dampers: what they brake stops as exp(-c t / m), second order; stiff ones give no energy") {
  const auto braked = [](double damping, const std::string& scheme, double h, double duration) {
    Scene s{.duration = duration};
    const auto body = s.body({.mass = 2, .position = {1, 0}, .velocity = {3, 0}});
    s.spring(PointSpring{.a = kGround, .b = body, .damping = damping});
    const Run r = run(s, scheme, h);
    REQUIRE(r.status == Status::solved);
    return r.final;
  };
  for (const std::string& scheme : kSecondOrder) {
    CAPTURE(scheme);
    const auto error = [&](double h) {
      return std::abs(braked(10, scheme, h, 0.4).v[0] - 3 * std::exp(-10 * 0.4 / 2));
    };
    CHECK(std::log2(error(0.02) / error(0.01)) == doctest::Approx(2).epsilon(0.05));
    const State stiff = braked(1e6, scheme, 1e-3, 0.04);
    CHECK(std::abs(stiff.v[0]) <= 3);
    CHECK(std::abs(stiff.q[0] - 1) <= 0.01);
  }
}

TEST_CASE("a ball on a table that is moved up and down: a wall of a driven body") {
  // The table falls away faster than g: the ball flies, and lands on it with e = 0.
  const double A = 0.1, W = 15;
  Scene s{.gravity = {0, -9.81}, .duration = 0.45};
  const auto table = s.body({.name = "table", .velocity = {0, A * W}}),
             ball = s.body({.name = "ball", .position = {0, 0.1}, .velocity = {0, A * W}});
  s.joint(Prismatic{"column", kGround, table, {0, 0}, {0, 0}, {0, 1}, 0});
  s.joint(Drive{"shaker", Slide{kGround, table, {0, 0}, {0, 0}, {0, 1}}, {.amplitude = A, .omega = W}});
  s.contact(DiscWall{"foot", ball, {0, 0}, 0.1, table, {0, 0}, {0, 1}, {}});
  const double leaves = std::asin(9.81 / (A * W * W)) / W;  // s̈ = −g
  for (const std::string& scheme : {kLocating[0], kLocating[1]}) {
    CAPTURE(scheme);
    double released = -1, landed = -1;
    const Run r = run(s, scheme, 0.01, [&](const RunSample& m) {
      for (const Event& e : m.events) {
        if (e.kind == EventKind::release && released < 0) released = e.t;
        if (e.kind == EventKind::impact && released >= 0 && landed < 0) landed = e.t;
      }
    });
    CHECK(r.status == Status::solved);
    CHECK(released == doctest::Approx(leaves).epsilon(1e-5));
    const double fall = landed - leaves;
    CHECK(A * std::sin(W * leaves) + A * W * std::cos(W * leaves) * fall - 9.81 / 2 * fall * fall ==
          doctest::Approx(A * std::sin(W * landed)).epsilon(1e-5));
  }
}

TEST_CASE("an arm between two stops bounces to and fro") {
  Scene s{.duration = 4};
  const auto arm = s.body({.name = "arm", .inertia = 2, .position = {0.5, 0}, .velocity = {0, 0.5}, .omega = 1});
  s.joint(Revolute{"hinge", kGround, arm, {0, 0}, {-0.5, 0}});
  s.contact(Limit{"up", Angle{kGround, arm}, Limit::Side::upper, 1, {.e = 0.5}});
  s.contact(Limit{"down", Angle{kGround, arm}, Limit::Side::lower, -0.5, {.e = 0.5}});
  // Up at t = 1, back at half the speed over 1.5 rad at t = 4.
  for (const std::string& scheme : kEveryScheme) {
    CAPTURE(scheme);
    s.duration = 2;
    const Run r = run(s, scheme, 1e-3);
    REQUIRE(r.status == Status::solved);
    CHECK(r.final.q[2] == doctest::Approx(0.5).epsilon(3e-3));
    CHECK(r.final.v[2] == doctest::Approx(-0.5).epsilon(1e-5));
  }
  s.duration = 5;
  const Run r = run(s, kLocating[0], 0.1);
  CHECK(r.final.q[2] == doctest::Approx(-0.25).epsilon(1e-9));
  CHECK(r.final.v[2] == doctest::Approx(0.25).epsilon(1e-9));
}

TEST_CASE("a slide limit stops a slider; a rope turns back what pulls it taut") {
  for (const std::string& scheme : kEveryScheme) {
    CAPTURE(scheme);
    Scene s{.duration = 1};
    const auto slider = s.body({.name = "slider", .velocity = {1, 1}});
    s.joint(Prismatic{"rail", kGround, slider, {0, 0}, {0, 0}, Vector2d(1, 1).normalized(), 0});
    s.contact(
        Limit{"end", Slide{kGround, slider, {0, 0}, {0, 0}, Vector2d(1, 1).normalized()}, Limit::Side::upper, 0.5, {}});
    const Run stopped = run(s, scheme, 1e-3);
    CHECK(stopped.final.q.head<2>().norm() == doctest::Approx(0.5).epsilon(4e-3));
    CHECK(stopped.final.v.norm() < 1e-9);

    Scene tether{.duration = 2};
    const auto mass = tether.body({.name = "mass", .position = {0.6, 0}, .velocity = {0, 1}});
    tether.contact(Limit{"rope", Span{kGround, mass}, Limit::Side::upper, 1, {.e = 1}});
    const Run r = run(tether, scheme, 1e-3);
    REQUIRE(r.status == Status::solved);
    // Taut at (0.6, 0.8), t = 0.8; the velocity (0, 1) loses twice its part along the rope: (−0.96, −0.28).
    CHECK(std::abs(r.final.q[0] - (0.6 - 1.2 * 0.96)) < 5e-3);
    CHECK(std::abs(r.final.q[1] - (0.8 - 1.2 * 0.28)) < 5e-3);
  }
}

TEST_CASE("a journal slides in its bearing as a pendulum of the clearance's length swings") {
  // A point mass of the pendulum scene is the journal's centre; smooth, and started in touch.
  const double clearance = 0.05, start = 1.0, g = 9.81;
  Scene s{.gravity = {0, -g}, .duration = 0.5};
  const auto pin = s.body({.name = "pin",
                           .mass = 2,
                           .inertia = 0.1,
                           .position = {clearance * std::sin(start), -clearance * std::cos(start)}});
  s.contact(Journal{"bearing", pin, {0, 0}, 0.2, kGround, {0, 0}, 0.25, {}});
  // ω² = 2 g/c (cos θ − cos θ0) at any θ: energy; and the event-driven run agrees with the link.
  Scene link{.gravity = {0, -g}, .duration = 0.5};
  link.body(s.bodies[0]);
  link.joint(Distance{"link", kGround, 0, {0, 0}, {0, 0}, clearance});
  const Run expected = run(link, kLocating[0], 0.01);
  for (const std::string& scheme : kLocating) {
    CAPTURE(scheme);
    const Run r = run(s, scheme, 0.01);
    REQUIRE(r.status == Status::solved);
    CHECK(mismatch(r.final.q, expected.final.q) < 1e-5);
  }
  for (const std::string& scheme : {std::string("moreau-jean"), std::string("rattle")}) {
    CAPTURE(scheme);
    const Run r = run(s, scheme, 1e-4);
    REQUIRE(r.status == Status::solved);
    CHECK(mismatch(r.final.q, expected.final.q) < 1e-2);
  }
}

TEST_CASE("a journal dropped from the middle of its bearing strikes it when it has fallen through the clearance") {
  const double c = 1e-4;
  Scene s{.gravity = {0, -9.81}, .duration = 0.02};
  const auto pin = s.body({.name = "pin"});
  s.contact(Journal{"bearing", pin, {0, 0}, 0.01, kGround, {0, 0}, 0.01 + c, {.mu = 0.1}});
  for (const std::string& scheme : kEveryScheme) {
    CAPTURE(scheme);
    double first = -1;
    const Run r = run(s, scheme, 1e-5, [&](const RunSample& m) {
      if (first < 0 && m.impulses[0].normal > 0) first = m.state.t;
    });
    REQUIRE(r.status == Status::solved);
    CHECK(std::abs(first - std::sqrt(2 * c / 9.81)) < 5e-5);
    CHECK(std::abs(r.final.q[1] + c) < 1e-6);
    CHECK(r.final.v.norm() < 1e-6);
  }
}

TEST_CASE("clearance in the slider's pin, with friction and impacts: event-driven and adaptive stepping agree") {
  const auto scenes = std::filesystem::path(ORTHANT_TEST_DATA).parent_path().parent_path() / "core" / "scenes";
  Scene s = read_scene(scenes / "slider_crank_pin.toml");
  s.duration = 0.04;
  const Run located = run(s, kLocating[0], 1e-3), stepped = run(s, kLocating[1], 1e-3);
  REQUIRE(located.status == Status::solved);
  REQUIRE(stepped.status == Status::solved);
  CHECK(located.events > 20);
  CHECK(mismatch(located.final.q, stepped.final.q) < 1e-5);
}

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
