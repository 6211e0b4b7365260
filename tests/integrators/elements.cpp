// Driven joints, limits, ropes, clearance joints, dry friction in joints: exact answers, every integrator.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/pendulum.h>

#include <cmath>
#include <filesystem>

#include "experiments/support/fit_order.h"
#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

namespace orthant {

using testing::mismatch;

namespace {

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

}  // namespace orthant
