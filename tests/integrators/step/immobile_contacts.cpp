// Contacts that joints immobilise: the motion is the one without them, in every frame, at every scale.
#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

#include <orthant/core/mechanics/planar/contact_sets.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace orthant;
using orthant::testing::Draws;

namespace {

const std::vector<std::string> kFormsAndIntegrators = {
    "moreau-jean",     "moreau-jean:form=full",     "stewart-trinkle",
    "anitescu-potra",  "stewart-trinkle:form=full", "anitescu-potra:form=full",
    "paoli-schatzman", "paoli-schatzman:form=full", "generalized-alpha",
    "rattle",          "adaptive:rtol=1e-9",        "event-driven"};

/// Where a mechanism stands, and its units: lengths in L, masses in m, times in √L, so that gravity stays as it is.
struct Frame {
  double angle = 0;
  Vector2d origin{0, 0};
  double L = 1, m = 1;
  Vector2d turn(const Vector2d& d) const {
    return {std::cos(angle) * d.x() - std::sin(angle) * d.y(), std::sin(angle) * d.x() + std::cos(angle) * d.y()};
  }
  Vector2d at(const Vector2d& p) const { return origin + turn(L * p); }
  double time() const { return std::sqrt(L); }
};

Scene empty(const Frame& f, double duration = 0.25) {
  Scene s{.gravity = f.turn({0, -9.81})};
  s.duration = duration * f.time(), s.step = 5e-3 * f.time();
  return s;
}

/// A rod of length 1 whose end `pivot` stands still.
Body rod(const Frame& f, const Vector2d& pivot, double angle, double omega) {
  const Vector2d half(0.5 * std::cos(angle), 0.5 * std::sin(angle));
  return {.mass = f.m,
          .inertia = f.m * f.L * f.L / 12,
          .position = f.at(pivot + half),
          .angle = f.angle + angle,
          .velocity = f.turn(omega * f.L / f.time() * perp(half)),
          .omega = omega / f.time()};
}

const ContactLaw kRough{.mu = 0.5, .e = 0.3};

/// A wall of the ground through p, free side n.
CornerWall against(const Frame& f, const char* name, BodyId body, const Vector2d& point, const Vector2d& p,
                   const Vector2d& n) {
  return {name, body, f.L * point, kGround, f.at(p), f.turn(n), kRough};
}

Scene pendulum(const Frame& f, bool contacts) {
  Scene s = empty(f);
  s.body(rod(f, {0, 0}, -0.9, 2));
  s.joint(Revolute{"pin", kGround, 0, f.at({0, 0}), {-0.5 * f.L, 0}});
  if (!contacts) return s;
  s.contact(against(f, "floor", 0, {-0.5, 0}, {0, 0}, {0, 1}));
  s.contact(against(f, "ceiling", 0, {-0.5, 0}, {0, 0}, {0, -1}));
  s.contact(against(f, "wall", 0, {-0.5, 0}, {0, 0}, {0.6, 0.8}));
  return s;
}

/// The second rod's end lies on a wall of the first one, at the pin between them.
Scene double_pendulum(const Frame& f, bool contacts) {
  Scene s = empty(f);
  s.body(rod(f, {0, 0}, -0.9, 0));
  s.body(rod(f, {std::cos(-0.9), std::sin(-0.9)}, 0.4, 1));
  s.joint(Revolute{"pin", kGround, 0, f.at({0, 0}), {-0.5 * f.L, 0}});
  s.joint(Revolute{"knee", 0, 1, {0.5 * f.L, 0}, {-0.5 * f.L, 0}});
  if (!contacts) return s;
  s.contact(CornerWall{"on-rod", 1, {-0.5 * f.L, 0}, 0, {0.5 * f.L, 0}, {0, 1}, kRough});
  s.contact(CornerWall{"at-end", 1, {-0.5 * f.L, 0}, 0, {0.5 * f.L, 0}, {0.6, -0.8}, kRough});
  return s;
}

/// A bearing about the pin that touches its journal all the time: its centre turns about the journal's on a circle as
/// wide as the clearance.
Scene journal(const Frame& f, bool contacts) {
  Scene s = empty(f);
  s.body(rod(f, {0, 0}, -0.9, 2));
  s.joint(Revolute{"pin", kGround, 0, f.at({0, 0}), {-0.5 * f.L, 0}});
  if (contacts)
    s.contact(
        Journal{"shell", kGround, f.at({0, 0}), 0.25 * f.L, 0, {-0.375 * f.L, 0}, 0.375 * f.L, {.mu = 0.3, .e = 0.5}});
  return s;
}

/// A block on a rail between two guides that leave no clearance; its angle's limit is at an end, too.
Scene block_on_rail(const Frame& f, bool contacts) {
  Scene s = empty(f);
  constexpr double kSlope = -0.5;
  const Vector2d along(std::cos(kSlope), std::sin(kSlope));
  const double speed = f.L / f.time();
  s.body({.mass = f.m,
          .inertia = f.m * f.L * f.L / 6,
          .position = f.at({0.2, 0.1}),
          .angle = f.angle + kSlope,
          .velocity = f.turn(speed * along)});
  s.joint(Prismatic{"rail", kGround, 0, f.at({0.2, 0.1}), {0, 0}, f.turn(along), f.angle + kSlope});
  if (!contacts) return s;
  s.contact_set(guide({.name = "guide",
                       .a = 0,
                       .width = f.L,
                       .height = f.L,
                       .point = f.at({0.2, 0.1}),
                       .axis = f.turn(along),
                       .law = kRough}));
  s.contact(Limit{"end", Angle{kGround, 0}, Limit::Side::lower, f.angle + kSlope, {}});
  return s;
}

/// A slider that a drive holds at its stop, and a pendulum on it.
Scene held_at_stop(const Frame& f, bool contacts) {
  Scene s = empty(f);
  const Vector2d axis = f.turn({1, 0});
  s.body({.mass = f.m, .inertia = f.m * f.L * f.L / 6, .position = f.at({0.5, 0}), .angle = f.angle});
  s.body(rod(f, {0.5, 0}, -0.9, 2));
  const Vector2d start = f.at({0, 0});
  s.joint(Prismatic{"rail", kGround, 0, start, {0, 0}, axis, f.angle});
  s.joint(Drive{"motor", Slide{kGround, 0, start, {0, 0}, axis}, TimeLaw{.offset = 0.5 * f.L}});
  s.joint(Revolute{"pin", 0, 1, {0, 0}, {-0.5 * f.L, 0}});
  if (!contacts) return s;
  s.contact(Limit{"stop", Slide{kGround, 0, start, {0, 0}, axis}, Limit::Side::upper, 0.5 * f.L, {.e = 0.3}});
  s.contact(against(f, "wall", 0, {0.5, 0}, {1, 0}, {-1, 0}));
  return s;
}

/// A crank turned by a drive, and a slider on a rail whose corners slide in the planes of two walls.
Scene driven_slider_crank(const Frame& f, bool contacts) {
  Scene s = empty(f);
  const double r = 0.13, l = 0.26, crank = 0.26, rate = -9.3;
  const double lean = -std::asin(r / l * std::sin(crank));
  const Vector2d B(r * std::cos(crank), r * std::sin(crank)), C(B.x() + l * std::cos(lean), 0);
  const auto body = [&](const Vector2d& at, double angle) {
    s.body({.mass = f.m, .inertia = 0.005 * f.m * f.L * f.L, .position = f.at(at), .angle = f.angle + angle});
  };
  body(B / 2, crank), body((B + C) / 2, lean), body(C, 0);
  const Vector2d start = f.at({0, 0});
  s.joint(Revolute{"O", kGround, 0, start, {-0.5 * r * f.L, 0}});
  s.joint(Revolute{"B", 0, 1, {0.5 * r * f.L, 0}, {-0.5 * l * f.L, 0}});
  s.joint(Revolute{"C", 1, 2, {0.5 * l * f.L, 0}, {0, 0}});
  s.joint(Prismatic{"rail", kGround, 2, start, {0, 0}, f.turn({1, 0}), f.angle});
  s.joint(Drive{"motor", Angle{kGround, 0}, TimeLaw{.offset = f.angle + crank, .rate_of_change = rate / f.time()}});
  if (!contacts) return s;
  s.contact(against(f, "above", 2, {-0.05, 0.025}, {0, 0.025}, {0, -1}));
  s.contact(against(f, "below", 2, {-0.05, -0.025}, {0, -0.025}, {0, 1}));
  return s;
}

struct Mechanism {
  const char* name;
  Scene (*make)(const Frame&, bool contacts);
};
constexpr Mechanism kMechanisms[] = {{"pendulum", &pendulum},         {"double pendulum", &double_pendulum},
                                     {"journal", &journal},           {"block on rail", &block_on_rail},
                                     {"held at stop", &held_at_stop}, {"driven slider-crank", &driven_slider_crank}};

Frame random_frame(Draws& draw, int kind) {
  Frame f{.angle = draw(-3, 3)};
  if (kind == 1) f.origin = 1e3 * draw.direction();
  if (kind == 2) f.origin = 1e6 * draw.direction();
  if (kind == 3) f.L = std::pow(10, draw(-3, 3));
  if (kind == 4) f.m = std::pow(10, draw(-6, 6));
  if (kind == 6) f.angle = 0;
  if (kind == 7) f.angle = std::numbers::pi / 2;
  if (kind == 5) f.L = std::pow(10, draw(-1, 2)), f.m = std::pow(10, draw(-6, 6)), f.origin = 1e3 * draw.direction();
  return f;
}

}  // namespace

TEST_CASE("contacts that joints immobilise change no motion, by any integrator, in either form, in any frame") {
  Draws draw(32);
  for (int kind = 0; kind < 8; ++kind)
    for (const Mechanism& mechanism : kMechanisms) {
      const Frame f = random_frame(draw, kind);
      for (const std::string& name : kFormsAndIntegrators) {
        CAPTURE(mechanism.name);
        CAPTURE(name);
        CAPTURE(kind);
        const Scene with = mechanism.make(f, true), without = mechanism.make(f, false);
        const Run a = run(with, name, with.step), b = run(without, name, without.step);
        CHECK_MESSAGE(a.status == Status::solved, a.why);
        REQUIRE(b.status == Status::solved);
        if (a.status != Status::solved) continue;
        double off = 0;  // of lengths over L, of angles
        for (Index i = 0; i < a.final.q.size(); ++i)
          off = std::max(off, std::abs(a.final.q[i] - b.final.q[i]) / (i % 3 == 2 ? 1 : f.L));
        CHECK(off <= 1e-8 + 1e-14 * f.origin.norm() / f.L * 1e2);
      }
    }
}

TEST_CASE("a plank hinged at a corner that lies on the floor falls flat, or bounces, by every integrator") {
  // After a public bug report, raisim#60. θ(0.8) with e = 0.5 by event location and quadrature of the pendulum.
  for (const double e : {0.0, 0.5})
    for (const std::string& name : kFormsAndIntegrators) {
      CAPTURE(name);
      CAPTURE(e);
      Scene s{.gravity = {0, -9.81}};
      s.duration = 0.8;
      s.body({.name = "plank",
              .mass = 1,
              .inertia = 0.08416666666666667,
              .position = {0.20669872981077807, 0.4580127018922193},
              .angle = std::numbers::pi / 3});
      s.joint(Revolute{"hinge", kGround, 0, {0, 0}, {-0.5, -0.05}});
      s.contact_set(polygon_wall({.name = "floor", .a = 0, .normal = {0, 1}, .law = {.mu = 0.5, .e = e}},
                                 {{-0.5, -0.05}, {0.5, -0.05}, {0.5, 0.05}, {-0.5, 0.05}}));
      const bool exact = name == "event-driven" || name.starts_with("adaptive");
      const Run r = run(s, name, 5e-4);
      CHECK_MESSAGE(r.status == Status::solved, r.why);
      CHECK(std::abs(r.final.q[2] - (e > 0 ? 0.1228134 : 0)) <=
            (exact ? 5e-8 : 3e-3));  // one step of the impact's 5.3 rad/s
    }
}

TEST_CASE("combinations of contacts that joints immobilise: supports on either side of a pin, two feet on a lift") {
  Draws draw(33);
  for (int kind = 0; kind < 8; ++kind)
    for (const std::string& name : kFormsAndIntegrators) {
      CAPTURE(name);
      CAPTURE(kind);
      const Frame f = random_frame(draw, kind);
      Scene seesaw = empty(f);  // heavier on one side; it stays
      Body beam = rod(f, {-0.5, 0}, 0, 0);
      seesaw.body(beam);
      seesaw.body({.mass = 3 * f.m, .inertia = f.m * f.L * f.L, .position = f.at({0.3, 0.2}), .angle = f.angle});
      seesaw.joint(Revolute{"pin", kGround, 0, f.at({0, 0}), {0, 0}});
      seesaw.joint(Fixed{"load", 0, 1, {0.3 * f.L, 0.2 * f.L}, {0, 0}, 0});
      seesaw.contact(against(f, "left", 0, {-0.5, 0}, {-0.5, 0}, {0, 1}));
      seesaw.contact(against(f, "right", 0, {0.5, 0}, {0.5, 0}, {0, 1}));
      const Run still = run(seesaw, name, seesaw.step);
      CHECK_MESSAGE(still.status == Status::solved, still.why);
      CHECK(std::abs(still.final.q[2] - f.angle) <= 1e-9 + 1e-12 * f.origin.norm() / f.L);

      Scene lift = empty(f, 0.5);  // falls 0.2, the feet strike together, it lies
      lift.body({.mass = f.m, .inertia = f.m * f.L * f.L / 6, .position = f.at({0, 0.2}), .angle = f.angle});
      lift.joint(Prismatic{"rail", kGround, 0, f.at({0, 0}), {0, 0}, f.turn({0, 1}), f.angle});
      for (const double x : {-0.5, 0.0, 0.5}) {
        CornerWall foot = against(f, "", 0, {x, 0}, {0, 0}, {0, 1});
        foot.law.e = 0;
        lift.contact(foot);
      }
      const Run lies = run(lift, name, lift.step);
      CHECK_MESSAGE(lies.status == Status::solved, lies.why);
      const double height = (lies.final.q.head<2>() - f.origin).norm() / f.L;
      CHECK(height <= 6e-3);  // schemes at velocity level stop within a step of it
    }
}

TEST_CASE("a drive that presses a contact shut is a proved contradiction; rest at the stop is not") {
  for (const std::string& name : kFormsAndIntegrators)
    for (const double angle : {0.0, 0.7}) {
      CAPTURE(name);
      CAPTURE(angle);
      const Frame f{.angle = angle};
      Scene s = empty(f, 1);
      const Vector2d axis = f.turn({1, 0});
      s.body({.mass = 1, .inertia = 1, .position = f.at({0.3, 0}), .angle = angle, .velocity = -axis});
      s.joint(Prismatic{"rail", kGround, 0, {0, 0}, {0, 0}, axis, angle});
      s.joint(Drive{"motor", Slide{kGround, 0, {0, 0}, {0, 0}, axis}, TimeLaw{.offset = 0.3, .rate_of_change = -1}});
      s.contact(CornerWall{"stop", 0, {0, 0}, kGround, {0, 0}, axis, {}});
      const Run r = run(s, name, 1e-2);
      CHECK(r.status == Status::infeasible);
      CHECK(std::abs(r.final.t - 0.3) <= 1e-2 + 1e-9);
    }
}

TEST_CASE("a drive that only touches a stop where it turns round goes on; one that turns a little later is jammed") {
  constexpr double omega = 2 * std::numbers::pi;
  for (const std::string& name : kFormsAndIntegrators)
    for (const double h : {1e-3, 9e-4, 1e-4}) {
      CAPTURE(name);
      CAPTURE(h);
      const auto touch = [&](double upper) {
        Scene s;
        s.duration = 0.5;
        s.body({.mass = 1, .inertia = 0.1, .omega = omega});
        s.joint(Revolute{"pin", kGround, 0, {0, 0}, {0, 0}});
        s.joint(Drive{"motor", Angle{kGround, 0}, TimeLaw{.amplitude = 1, .omega = omega}});
        s.contact(Limit{"stop", Angle{kGround, 0}, Limit::Side::upper, upper, {.e = 0.5}});
        return run(s, name, h);
      };
      CHECK(touch(1).status == Status::solved);
      CHECK(touch(0.99).why.starts_with("jammed"));
    }
}

TEST_CASE("relaxed cones that leave no common velocity are not called a jam") {
  Scene s{.gravity = {0, 0}};  // a slider between two rough walls, with a clearance that slip uses up in one step
  s.duration = 0.1;
  s.body({.mass = 1, .inertia = 1e-3, .velocity = {1, 0}});
  s.joint(Drive{"motor", Slide{kGround, 0, {0, 0}, {0, 0}, {1, 0}}, TimeLaw{.rate_of_change = 1}});
  s.contact(CornerWall{"above", 0, {0, 0.025}, kGround, {0, 0.026}, {0, -1}, {.mu = 1}});
  s.contact(CornerWall{"below", 0, {0, -0.025}, kGround, {0, -0.026}, {0, 1}, {.mu = 1}});
  const Run coulomb = run(s, "moreau-jean", 2e-3), relaxed = run(s, "anitescu-potra", 2e-3);
  CHECK(coulomb.status == Status::solved);
  CHECK(relaxed.status == Status::stalled);
  CHECK_MESSAGE(relaxed.why.find("relaxed friction cones of contacts") != std::string::npos, relaxed.why);
  CHECK(run(s, "anitescu-potra", 2e-4).status == Status::solved);
}

TEST_CASE("a tower that rounding does not let decide is not called infeasible") {
  for (const std::string& name : kFormsAndIntegrators) {
    if (name.starts_with("adaptive")) continue;  // it takes its steps until they are used up
    CAPTURE(name);
    Scene s{.gravity = {0, -9.81}};
    s.duration = 0.05;
    for (int i = 0; i < 4; ++i) {
      const double m = std::pow(1e6, i);
      s.body({.mass = m, .inertia = m / 6, .position = {0, i + 0.5}});
      s.contact(CornerWall{"", i, {0, -0.5}, i - 1, {0, i == 0 ? 0 : 0.5}, {0, 1}, {}});
    }
    const Run r = run(s, name, 0x1p-7);
    CHECK(r.status != Status::infeasible);
    CHECK(r.why.find("Painlev") == std::string::npos);
    if (r.status != Status::solved) CHECK(r.why.find("rounding leaves undecided") != std::string::npos);
  }
}
