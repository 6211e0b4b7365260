// Admissibility of motions: jams, overlaps, energy balances, the same for every integrator.
#include "tests/support/runs.h"
#include "tests/support/told_time.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/motion.h>
#include <orthant/integrators/step/jam.h>

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

namespace {

/// A four-bar: the crank is driven at `rate`, the pin between coupler and rocker has a clearance of 0.2 mm, a stop
/// holds the rocker back at the angle `stop`.
Scene four_bar(double stop, double mu, double e_pin, double e_stop, double rate = 20) {
  Scene s{.gravity = {0, -kGravity}};
  const auto crank = s.body({.name = "crank",
                             .mass = 0.5,
                             .inertia = 5e-4,
                             .position = {0, 0.05},
                             .angle = std::numbers::pi / 2,
                             .omega = rate}),
             coupler = s.body({.name = "coupler",
                               .mass = 1,
                               .inertia = 7.5e-3,
                               .position = {0.141547, 0.149642},
                               .angle = 0.337307}),
             rocker = s.body(
                 {.name = "rocker", .mass = 0.8, .inertia = 3e-3, .position = {0.291547, 0.099642}, .angle = 1.655424});
  s.joint(Revolute{"shaft", kGround, crank, {0, 0}, {-0.05, 0}});
  s.joint(Drive{"motor", Angle{kGround, crank}, {.offset = std::numbers::pi / 2, .rate_of_change = rate}});
  s.joint(Revolute{"A", crank, coupler, {0.05, 0}, {-0.15, 0}});
  s.joint(Revolute{"D", kGround, rocker, {0.3, 0}, {-0.1, 0}});
  s.contact(Journal{"B", coupler, {0.15, 0}, 0.01, rocker, {0.1, 0}, 0.0102, {.mu = mu, .e = e_pin}});
  s.contact(Limit{"stop", Angle{kGround, rocker}, Limit::Side::lower, stop, {.e = e_stop}});
  return s;
}

/// The time at which the coupler has pushed the rocker against its stop: the crank's tip is as near to the pin's place
/// there as coupler and clearance let it.
double jam_time(double stop, double rate) {
  const Vector2d pin(0.3 + 0.2 * std::cos(stop), 0.2 * std::sin(stop));
  const auto apart = [&](double t) {
    const double angle = std::numbers::pi / 2 + rate * t;
    return (Vector2d(0.1 * std::cos(angle), 0.1 * std::sin(angle)) - pin).norm() - (0.3 - 2e-4);
  };
  double low = 0.6 * 2 * std::numbers::pi / rate, high = low;  // the tip is far away there
  while (apart(high = low + 1e-4) > 0) low = high;
  for (int i = 0; i < 60; ++i) (apart((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
  return low;
}

}  // namespace

TEST_CASE("a driven crank against a stop: every integrator ends at the jam, in the same words") {
  const std::string words = "jammed: drive \"motor\", contacts \"B\" and \"stop\" leave no motion; since t = ";
  struct Case {
    double stop, mu, e_pin, e_stop;
  };
  for (const Case& c : {Case{1.4, 0, 0, 0}, {1.5, 0, 0, 0}, {1.6, 0.1, 0, 0}, {1.4, 0.5, 0.3, 0}})
    for (const IntegratorEntry& scheme : integrators()) {
      if (scheme.name == "generalized-alpha" && c.mu < 0.5) continue;  // its smooth motion does not converge there
      CAPTURE(scheme.name);
      CAPTURE(c.stop);
      const double due = jam_time(c.stop, 20);
      const Run r = run_for(four_bar(c.stop, c.mu, c.e_pin, c.e_stop), 0.3, scheme.name, 1e-4);
      CAPTURE(r.why);
      CHECK(r.status == Status::infeasible);
      CHECK(r.why.starts_with(words));
      CHECK(told_time(r.why) == doctest::Approx(due).epsilon(2e-5));
      CHECK(std::abs(r.final.t - due) < 5e-4);
    }
}

TEST_CASE("a driven crank whose stop is out of the way: no integrator speaks of a jam, and the energy balances") {
  for (const IntegratorEntry& scheme : integrators()) {
    if (scheme.name == "generalized-alpha") continue;
    CAPTURE(scheme.name);
    const Run r = run_for(four_bar(0.9, 0.1, 0.3, 0.2), 0.4, scheme.name, 1e-4);
    CAPTURE(r.why);
    CHECK(r.status == Status::solved);
    CHECK(r.motion.smallest_clearance == doctest::Approx(2e-4).epsilon(1e-9));
    CHECK(std::abs(r.energy_final - r.energy_initial - r.motion.work) < 0.2 * r.motion.energy_scale);
    CHECK(r.motion.energy_defect < 1e-3 * r.motion.energy_scale);
    CHECK(warnings_of(r.motion).empty());
  }
}

TEST_CASE("a drive into a wall or a floor: one explanation for all integrators") {
  Scene s;
  const BodyId ram = s.body({.name = "ram", .position = {0.3, 0}, .velocity = {-1, 0}});
  s.joint(Prismatic{"rail", kGround, ram, {0, 0}, {0, 0}, {1, 0}, 0});
  s.joint(Drive{"push", Slide{kGround, ram, {0, 0}, {0, 0}, {1, 0}}, {.offset = 0.3, .rate_of_change = -1}});
  s.contact(CornerWall{"stop", ram, {0, 0}, kGround, {0, 0}, {1, 0}, {}});
  for (const IntegratorEntry& scheme : integrators())
    for (const double h : {1e-3, 0.017}) {
      CAPTURE(scheme.name);
      const Run r = run_for(s, 1, scheme.name, h);
      CHECK(r.status == Status::infeasible);
      CHECK(r.why == "jammed: drive \"push\", contact \"stop\" leave no motion; since t = 0.3");
      CHECK(std::abs(r.final.t - 0.3) < 2 * h);
    }
}

TEST_CASE("two drives of one joint that differ, a vise that closes on a disc: jammed, and which drives") {
  Scene fight;
  const BodyId arm = fight.body({.name = "arm"});
  fight.joint(Revolute{"pin", kGround, arm, {0, 0}, {0, 0}});
  fight.joint(Drive{"one", Angle{kGround, arm}, {.rate_of_change = 1}});
  fight.joint(Drive{"other", Angle{kGround, arm}, {.rate_of_change = 2}});
  Scene vise;
  const BodyId jaw = vise.body({.name = "jaw", .position = {1, 0}, .velocity = {-1, 0}}),
               disc = vise.body({.name = "disc", .inertia = 0.01, .position = {0.3, 0}});
  vise.joint(Prismatic{"rail", kGround, jaw, {0, 0}, {0, 0}, {1, 0}, 0});
  vise.joint(Drive{"ram", Slide{kGround, jaw, {0, 0}, {0, 0}, {1, 0}}, {.offset = 1, .rate_of_change = -1}});
  vise.contact(DiscWall{"wall", disc, {0, 0}, 0.1, kGround, {0, 0}, {1, 0}, {.mu = 0.2, .e = 0.3}});
  vise.contact(DiscWall{"face", disc, {0, 0}, 0.1, jaw, {0, 0}, {-1, 0}, {.mu = 0.2, .e = 0.3}});
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    const Run a = run_for(fight, 0.1, scheme.name, 1e-3), b = run_for(vise, 1, scheme.name, 1e-3);
    CHECK(a.status == Status::infeasible);
    CHECK(a.why == "jammed: drives \"one\" and \"other\", the joints leave no motion; since t = 0");
    CHECK(b.status == Status::infeasible);
    CHECK(b.why == "jammed: drive \"ram\", contacts \"wall\" and \"face\" leave no motion; since t = 0.8");
    CHECK(std::abs(b.final.t - 0.8) < 3e-3);
  }
}

TEST_CASE("drives that agree at the points of their tables only: no row is written within their jam") {
  Scene s;
  const BodyId arm = s.body({.name = "arm"});
  s.joint(Revolute{"pin", kGround, arm, {0, 0}, {0, 0}});
  const std::vector<double> times{0, 0.3, 0.6, 1};
  s.joint(Drive{"one", Angle{kGround, arm}, {.table = Spline(times, {0, 0.3, 0.3, 0.3})}});
  s.joint(Drive{"other", Angle{kGround, arm}, {.table = Spline(times, {0, 0.3, 0.3, 0.9})}});
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    double last = -1;
    const Run r = run_for(s, 1, scheme.name, 1e-2, [&](const RunSample& m) { last = m.state.t; });
    CHECK(r.status == Status::infeasible);
    CHECK(r.why.starts_with("jammed: drives \"one\" and \"other\", the joints leave no motion"));
    CHECK(told_time(r.why) < 1e-3);
    CHECK(last == 0);
  }
}

TEST_CASE("a position search: a disc in a slot, as wide as it or narrower by a drive's way") {
  Scene s;
  const BodyId wall = s.body({.name = "wall", .position = {0.2, 0}}),
               disc = s.body({.name = "disc", .position = {0.1, 0}});
  s.joint(Prismatic{"rail", kGround, wall, {0, 0}, {0, 0}, {1, 0}, 0});
  s.joint(Drive{"push", Slide{kGround, wall, {0, 0}, {0, 0}, {1, 0}}, {.offset = 0.25, .rate_of_change = -0.1}});
  s.contact(DiscWall{"left", disc, {0, 0}, 0.1, kGround, {0, 0}, {1, 0}, {}});
  s.contact(DiscWall{"right", disc, {0, 0}, 0.1, wall, {0, 0}, {-1, 0}, {}});
  const System system(s);
  JamSearch search(system);
  Eigen::VectorXd q = system.initial_state().q;
  CHECK(search.fits(0.499999, q));
  CHECK(!search.fits(0.5001, q));
  const auto jam = search.find(system.initial_state(), 1);
  REQUIRE(jam.has_value());
  CHECK(jam->since == doctest::Approx(0.5).epsilon(1e-7));
  CHECK(words(*jam) == "jammed: drive \"push\", contacts \"left\" and \"right\" leave no motion; since t = 0.5");
  CHECK(!search.find(system.initial_state(), 0.49).has_value());
}

TEST_CASE("a ball that bounces for ever: no scheme loses or gains much energy, and none warns of it") {
  Scene s{.gravity = {0, -kGravity}};
  const BodyId ball = s.body({.name = "ball", .inertia = 0.01, .position = {0, 1.1}});
  s.contact(DiscWall{"floor", ball, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.e = 1}});
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    const Run r = run_for(s, 20, scheme.name, 1e-3);
    CHECK(r.status == Status::solved);
    const double off = std::abs(r.energy_final - r.energy_initial);
    CHECK(r.motion.energy_scale == doctest::Approx(kGravity).epsilon(0.01));
    CHECK(r.motion.energy_defect >= 0.9 * off);
    CHECK(off < 0.01 * kGravity);
    CHECK(warnings_of(r.motion).empty());
  }
}

TEST_CASE("energy that a scheme loses where nothing in the scene takes it is a defect") {
  Scene s{.gravity = {0, -kGravity}};
  const BodyId rod = s.body({.name = "rod", .inertia = 0.1, .position = {1, 0}});
  s.joint(Revolute{"pin", kGround, rod, {0, 0}, {-1, 0}});
  const Run r = run_for(s, 10, "stewart-trinkle", 1e-2);
  CHECK(r.status == Status::solved);
  const double lost = r.energy_initial - r.energy_final;
  CHECK(lost > 0.05 * kGravity);
  CHECK(r.motion.energy_defect >= (1 - 1e-9) * lost);
  CHECK(warnings_of(r.motion).size() == 1);
}

TEST_CASE("elastic impacts: the schemes of position level keep the energy, wherever in the step an impact falls") {
  Scene s{.gravity = {0, -kGravity}};
  const BodyId ball = s.body({.name = "ball", .inertia = 0.01, .position = {0, 1.1}, .velocity = {0.7, 0}});
  s.contact(DiscWall{"floor", ball, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.e = 1}});
  s.contact(DiscWall{"slope", ball, {0, 0}, 0.1, kGround, {2, 0}, {-3, 1}, {.e = 1}});
  s.contact(DiscWall{"wall", ball, {0, 0}, 0.1, kGround, {-1, 0}, {1, 0}, {.e = 1}});
  s.contact(DiscWall{"roof", ball, {0, 0}, 0.1, kGround, {0, 1.3}, {0, -1}, {.e = 1}});
  for (Contact& c : s.contacts) std::get<DiscWall>(c).normal.normalize();
  for (const char* scheme : {"rattle", "generalized-alpha"})
    for (const double h : {4e-3, 1e-3}) {
      CAPTURE(scheme);
      CAPTURE(h);
      const Run r = run_for(s, 60, scheme, h);
      CHECK(r.status == Status::solved);
      CHECK(r.motion.energy_defect < 0.01 * r.motion.energy_scale);
    }
}

TEST_CASE("bodies at rest at all rows: energy that goes through them in between is no defect") {
  // A box rides on a shaken table; rows at the period show both at rest, at the same height.
  Scene s{.gravity = {0, -kGravity}};
  const double height = 0.01, rate = 15;
  const BodyId table = s.body({.name = "table", .mass = 20, .position = {0, -height}}),
               box = s.body({.name = "box", .inertia = 0.02, .position = {0, 0.15 - height}});
  s.joint(Prismatic{"column", kGround, table, {0, 0}, {0, 0}, {0, 1}, 0});
  s.joint(Drive{"shaker",
                Slide{kGround, table, {0, 0}, {0, 0}, {0, 1}},
                {.amplitude = height, .omega = rate, .phase = -std::numbers::pi / 2}});
  for (const double x : {-0.2, 0.2})
    s.contact(CornerWall{"", box, {x, -0.15}, table, {0, 0}, {0, 1}, {.mu = 0.4, .e = 0.2}});
  for (const char* scheme : {"event-driven", "adaptive"}) {
    CAPTURE(scheme);
    const Run r = run_for(s, 50 * 2 * std::numbers::pi / rate, scheme, 2 * std::numbers::pi / rate);
    REQUIRE(r.status == Status::solved);
    CHECK(r.motion.energy_scale > 50 * 2 * 20 * kGravity * height);  // what the drive lifts in each period
    CHECK(warnings_of(r.motion).empty());
  }
  Scene ball{.gravity = {0, -kGravity}};  // elastic: at its top at all rows
  const BodyId disc = ball.body({.inertia = 0.01, .position = {0, 1.1}});
  ball.contact(DiscWall{"floor", disc, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.e = 1}});
  const double period = 2 * std::sqrt(2 / kGravity);
  const Run r = run_for(ball, 10 * period, "event-driven", period);
  CHECK(r.motion.energy_scale == doctest::Approx(kGravity).epsilon(1e-6));
}

TEST_CASE("work of loads, belts and drives is what the energy changes by, whatever the integrator") {
  Scene s{.gravity = {0, -kGravity}};
  const BodyId box = s.body({.name = "box", .inertia = 1e6, .position = {0, 0.1}}),
               arm = s.body({.name = "arm", .inertia = 0.1, .position = {3, 0}}),
               cart = s.body({.name = "cart", .position = {0, 5}}), bob = s.body({.name = "bob", .position = {1, 4}});
  s.contact(CornerWall{"floor", box, {0, -0.1}, kGround, {0, 0}, {0, 1}, {.mu = 0.3, .belt = 2}});
  s.joint(Revolute{"pin", kGround, arm, {3, 0}, {0, 0}});
  const auto factor = [](double t) { return 1 + std::sin(7 * t); };
  s.load({.name = "torque", .body = arm, .torque = 1, .factor = factor, .omega = 7});
  s.joint(Prismatic{"rail", kGround, cart, {0, 5}, {0, 0}, {1, 0}, 0});
  s.joint(Drive{"shake", Slide{kGround, cart, {0, 5}, {0, 0}, {1, 0}}, {.amplitude = 0.2, .omega = 5}});
  s.joint(Distance{"rope", cart, bob, {0, 0}, {0, 0}, std::sqrt(2)});
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    const Run r = run_for(s, 1, scheme.name, 1e-3);
    CAPTURE(r.why);
    CHECK(r.status == Status::solved);
    const double kept = r.energy_final - r.energy_initial - r.motion.work;  // friction at the belt took the rest
    const double speed = 0.3 * kGravity, slides = 2 / speed;                // until the box runs with the belt
    CHECK(kept == doctest::Approx(-0.3 * kGravity * (2 * slides - speed * slides * slides / 2)).epsilon(0.02));
    CHECK(r.motion.energy_defect < 0.01 * r.motion.energy_scale);
  }
}

TEST_CASE("work of a load that swings is that of the whole step, and of the part of a step that a run ends in") {
  Scene s;
  const BodyId arm = s.body({.name = "arm", .inertia = 0.1});
  s.joint(Revolute{"pin", kGround, arm, {0, 0}, {0, 0}});
  const auto factor = [](double t) { return 1 + std::sin(7 * t); };
  s.load({.name = "torque", .body = arm, .torque = 1, .factor = factor, .omega = 7});
  const auto lost = [&](const char* scheme, double duration, double h) {
    const Run r = run_for(s, duration, scheme, h);
    CHECK(r.status == Status::solved);
    return std::abs(r.energy_final - r.energy_initial - r.motion.work);
  };
  for (const double duration : {0.31, 0.5, 0.83}) {
    CAPTURE(duration);
    for (const char* scheme : {"moreau-jean", "generalized-alpha", "rattle"}) {  // of second order
      CAPTURE(scheme);
      CHECK(lost(scheme, duration, 5e-3) < 0.3 * lost(scheme, duration, 1e-2) + 1e-12);
    }
    for (const char* scheme : {"adaptive", "event-driven"}) {
      CAPTURE(scheme);
      CHECK(lost(scheme, duration, duration) < 1e-5);
      CHECK(lost(scheme, duration, 1e-2) < 1e-5);
    }
  }
}

TEST_CASE("a start deep in the floor: shooting it off is not admissible, lifting it is reported") {
  Scene s{.gravity = {0, -kGravity}};
  const BodyId ball = s.body({.name = "ball", .inertia = 0.01, .position = {0, 0.02}});
  s.contact(DiscWall{"floor", ball, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.e = 0.5}});
  CHECK(run_for(s, 0.2, "paoli-schatzman", 1e-3).status == Status::numerical_error);  // at 120 m/s
  for (const char* scheme : {"rattle", "generalized-alpha"}) {
    const Run lifted = run_for(s, 0.2, scheme, 1e-3);
    CHECK(lifted.status == Status::solved);
    CHECK(lifted.motion.energy_defect == doctest::Approx(0.08 * kGravity).epsilon(0.01));
    CHECK(warnings_of(lifted.motion).size() == 1);
  }
}

TEST_CASE("a step too long for a clearance is reported with figure and time; far out of it the run ends") {
  const Scene s = four_bar(1.3, 0, 0.3, 0.2);
  const Run r = run_for(s, 0.4, "moreau-jean", 1e-4);
  CHECK(r.status == Status::solved);
  CHECK(r.motion.deep());
  CHECK(r.motion.max_overlap == r.max_penetration);
  REQUIRE(warnings_of(r.motion).size() == 1);
  CHECK(warnings_of(r.motion)[0].find("at contact \"B\"") != std::string::npos);
  CHECK(warnings_of(r.motion)[0].find("the clearance is 0.0002 m") != std::string::npos);
}

TEST_CASE("an angle that passes its limit is reported in rad") {
  Scene s;
  const BodyId arm = s.body({.name = "arm", .inertia = 0.1, .omega = 30});
  s.joint(Revolute{"pin", kGround, arm, {0, 0}, {0, 0}});
  s.contact(Limit{"stop", Angle{kGround, arm}, Limit::Side::upper, 0.16, {}});
  const Run r = run_for(s, 0.1, "moreau-jean", 1e-2);  // open at half of the first step; the second stops it
  CHECK(r.status == Status::solved);
  CHECK(r.motion.overlap_scale == OverlapScale::angle);
  CHECK(r.motion.max_overlap == doctest::Approx(0.29).epsilon(1e-9));
  REQUIRE(warnings_of(r.motion).size() == 1);
  CHECK(warnings_of(r.motion)[0].find("the limit of contact \"stop\" is exceeded by up to 0.29 rad") == 0);
}

TEST_CASE("a body that passes the end of its rope is reported as beyond a limit, not as an overlap of bodies") {
  Scene s;
  const BodyId stone = s.body({.name = "stone", .inertia = 0.1, .position = {1, 0}, .velocity = {30, 0}});
  s.contact(Limit{"rope", Span{kGround, stone}, Limit::Side::upper, 1.16, {}});
  const Run r = run_for(s, 0.1, "moreau-jean", 1e-2);
  CHECK(r.status == Status::solved);
  CHECK(r.motion.overlap_scale == OverlapScale::length);
  REQUIRE(warnings_of(r.motion).size() == 1);
  CHECK(warnings_of(r.motion)[0].find("the limit of contact \"rope\" is exceeded by up to 0.29 m, where a body's half "
                                      "width is 0.316 m") == 0);
}

TEST_CASE("a pin that drifts out of its bearing as it whirls ends the run, at ten clearances") {
  Scene s{.gravity = {0, -9.81}, .duration = 0.28};  // found by the storm of motions
  const BodyId rotor = s.body({.mass = 10, .inertia = 0.06, .position = {0, -3e-5}, .omega = -30});
  s.contact(Journal{"bearing", rotor, {0, 0}, 0.01, kGround, {0, 0}, 0.0101, {.mu = 2, .e = 0.3}});
  int ended = 0;
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    const Run r = run(s, scheme.name, 4.6e-4);
    CAPTURE(r.why);
    CHECK(r.motion.max_overlap < 1.5e-3);
    if (r.status == Status::solved) continue;
    ++ended;
    CHECK(r.status == Status::numerical_error);
    CHECK(r.why.starts_with("bodies overlap by 0.001"));
    CHECK(r.why.find("at contact \"bearing\", where the clearance is ") != std::string::npos);
  }
  CHECK(ended > 0);
  const Run fine = run(s, "moreau-jean", 2e-5);
  CHECK(fine.status == Status::solved);
  CHECK(fine.motion.max_overlap < 1e-3);
}

TEST_CASE("a rise of energy in the steps of an impact is seen, also where later steps lose it again") {
  Scene s{.gravity = {0, -9.81}, .duration = 0.03};  // found by the storm of motions
  const BodyId arm = s.body({.inertia = 0.0133, .position = {0.2, -3e-5}, .omega = 3});
  s.contact(Journal{"pin", arm, {-0.2, 0}, 0.01, kGround, {0, 0}, 0.0101, {.mu = 0.7, .e = 1}});
  const System system(s);
  double start = 0, most = 0;
  const Run r = run(s, "rattle", 1.5747432811441817e-3, [&](const RunSample& m) {
    const double now = energy(system, m.state);
    if (m.state.t == 0) start = now;
    most = std::max(most, now);
  });
  REQUIRE(r.status == Status::solved);
  CHECK(most > 1.1 * start);
  CHECK(r.motion.energy_defect >= (1 - 1e-9) * (most - start));
  CHECK(r.motion.energy_off());
}
