// Event-driven integration against exact motions and the golden slider-crank, and what it does where there is none.
#include "tests/support/allocations.h"
#include "tests/support/event_record.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/scenes/stick_slip.h>
#include <orthant/integrators/between_events/first_crossing.h>
#include <orthant/integrators/event_driven/dormand_prince.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

using namespace orthant;

TEST_CASE("Dormand-Prince: a step of order 8, exact on what order 8 integrates") {
  // q'' = −q from (1, 0): the error of one step goes with h⁹.
  DormandPrince rk(1);
  const auto error = [&](double h) {
    Eigen::VectorXd q = Eigen::VectorXd::Ones(1), v = Eigen::VectorXd::Zero(1), a = -q, q_next(1), v_next(1);
    const auto f = [](double, const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& acceleration) {
      acceleration = -x;
      return true;
    };
    REQUIRE(rk.step(f, 0, q, v, a, h, q_next, v_next, [](std::size_t) {}));
    return std::hypot(q_next[0] - std::cos(h), v_next[0] + std::sin(h));
  };
  const double order = std::log2(error(0.6) / error(0.3));
  MESSAGE("one step: order " << order);
  CHECK(std::abs(order - 9) < 0.3);
  CHECK(error(1.0) < 1e-6);
}

TEST_CASE("first crossing: the first of two roots is found, a touch is not a crossing") {
  const auto bow = [](double depth) {  // x² − x + ¼ − depth, its minimum at ½
    return quartic({0.25 - depth, 0.0625 - depth, -depth, 0.0625 - depth, 0.25 - depth});
  };
  const auto found = first_crossing(bow(0.01), 0);
  REQUIRE(found);
  CHECK(found->x == doctest::Approx(0.4).epsilon(1e-12));
  CHECK(found->slope == doctest::Approx(-0.2).epsilon(1e-3));
  CHECK(!first_crossing(bow(0), 0));
  CHECK(!first_crossing(bow(-1e-3), 0));
  // sin over [0, 4]: both forms find π to what their degree can.
  const auto five = first_crossing(quintic(0, 1, 0, std::sin(4), std::cos(4), -std::sin(4), 4), 0);
  const auto three = first_crossing(cubic(0, 1, std::sin(4), std::cos(4), 4), 0);
  REQUIRE((five && three));
  CHECK(4 * five->x == doctest::Approx(std::numbers::pi).epsilon(1e-2));
  CHECK(4 * three->x == doctest::Approx(std::numbers::pi).epsilon(0.1));
}

TEST_CASE("bouncing ball: passes the accumulation, rests exactly, all impulses counted") {
  for (const double e : {0.5, 0.9})
    for (const double step : {10.0, 0.01}) {
      CAPTURE(e);
      CAPTURE(step);
      const BouncingBall ball{.e = e};
      const EventRecord record = tell(bouncing_ball(ball), 10, step);
      REQUIRE(record.run.status == Status::solved);
      const auto impacts = record.of(EventKind::impact), accumulation = record.of(EventKind::accumulation);
      REQUIRE(accumulation.size() == 1);
      CHECK(accumulation[0].t == doctest::Approx(ball.zeno_time()).epsilon(1e-12));
      double sum = accumulation[0].normal;
      for (std::size_t i = 0; i < impacts.size(); ++i) {
        sum += impacts[i].normal;
        CHECK(impacts[i].t == doctest::Approx(ball.impact_time(static_cast<int>(i) + 1)).epsilon(1e-12));
      }
      CHECK(sum == doctest::Approx(kGravity * ball.zeno_time()).epsilon(1e-6));  // what is left of the series is lost
      CHECK(record.sum[0].normal == doctest::Approx(kGravity * 10).epsilon(1e-12));  // but not to the contact
      CHECK(record.run.final.q[1] == 0);
      CHECK(record.run.final.v[1] == 0);
    }
  CHECK(tell(bouncing_ball(), 1.3, 1.3).run.final.q[1] == doctest::Approx(2.4163733329496484e-4).epsilon(1e-12));
}

TEST_CASE("elastic ball: ten thousand impacts keep the energy and their times") {
  const BouncingBall ball{.e = 1};
  const EventRecord record = tell(bouncing_ball(ball), 9031, 9031);
  REQUIRE(record.events.size() == 10001);
  CHECK(record.events[9999].t == doctest::Approx(9030.0212960736324).epsilon(1e-12));
  CHECK(std::abs(record.run.energy_final / record.run.energy_initial - 1) <= 1e-12);
}

TEST_CASE("incline: sticks without creep, slides at the right rate, stops and turns back") {
  const double critical = std::tan(std::numbers::pi / 6);
  CHECK(std::abs(tell(incline({.mu = critical + 1e-6, .speed = 0}), 1, 0.1).run.final.v[0]) <= 1e-12);
  const double v = tell(incline({.mu = critical - 1e-6, .speed = 0}), 1, 0.1).run.final.v[0];
  CHECK(v == doctest::Approx(-kGravity * std::cos(std::numbers::pi / 6) * 1e-6).epsilon(1e-9));
  for (const Incline& p : {Incline{.mu = 0.5, .speed = 2}, Incline{.mu = 0.8, .speed = -2}}) {
    const EventRecord record = tell(incline(p), 2, 2);
    REQUIRE(record.events.size() == 1);
    CHECK(record.events[0].kind == (p.speed > 0 ? EventKind::slip : EventKind::stick));
    CHECK(record.events[0].t == doctest::Approx(p.stop_time()).epsilon(1e-13));
    CHECK(record.run.final.q[0] == doctest::Approx(p.at(2).x).epsilon(1e-12));
    CHECK(std::abs(record.run.final.v[0] - p.at(2).v) <= 1e-12);
  }
}

TEST_CASE("a block on two corners: redundant friction, both corners change together") {
  Scene s;
  const double slope = std::numbers::pi / 6, mu = 0.8;
  s.gravity = {-kGravity * std::sin(slope), -kGravity * std::cos(slope)};
  const auto block = s.body({.name = "block", .mass = 1, .inertia = 0.1, .position = {0, 0.1}, .velocity = {-2, 0}});
  for (const double x : {-0.3, 0.3}) s.contact(CornerWall{"", block, {x, -0.1}, kGround, {0, 0}, {0, 1}, {.mu = mu}});
  for (const std::string_view solver : {"lemke", "pgs", "newton-fb"}) {
    CAPTURE(solver);
    const EventRecord record = tell(s, 2, 0.5, solver);
    const Incline exact{.mu = mu, .speed = -2};
    REQUIRE(record.run.status == Status::solved);
    REQUIRE(record.events.size() == 2);
    CHECK(record.events[0].t == doctest::Approx(exact.stop_time()).epsilon(1e-12));
    CHECK(record.events[0].kind == EventKind::stick);
    CHECK(record.events[1].kind == EventKind::stick);
    CHECK(record.run.final.q[0] == doctest::Approx(exact.at(2).x).epsilon(1e-12));
    CHECK(std::abs(record.run.final.v[0]) <= 1e-12);
    const double weight = kGravity * std::cos(slope), pull = kGravity * std::sin(slope);
    CHECK(record.sum[0].normal + record.sum[1].normal == doctest::Approx(2 * weight).epsilon(1e-12));
    const double stop = exact.stop_time();
    CHECK(record.sum[0].tangent + record.sum[1].tangent ==
          doctest::Approx(mu * weight * stop + pull * (2 - stop)).epsilon(1e-11));
  }
}

TEST_CASE("stick-slip on a belt: both phases end on time, for ten periods") {
  const StickSlip p;
  const EventRecord record = tell(stick_slip(p), 10 * p.period(), 1);
  REQUIRE(record.run.status == Status::solved);
  const auto slips = record.of(EventKind::slip), sticks = record.of(EventKind::stick);
  REQUIRE(slips.size() == 10);
  REQUIRE(sticks.size() >= 9);
  for (std::size_t i = 0; i < 9; ++i) {
    CHECK(slips[i].t == doctest::Approx(static_cast<double>(i) * p.period() + p.stick_time()).epsilon(1e-11));
    CHECK(sticks[i].t == doctest::Approx(static_cast<double>(i + 1) * p.period()).epsilon(1e-11));
  }
  const EventRecord half = tell(stick_slip(p), p.stick_time() + 2, 1);
  CHECK(half.run.final.q[0] == doctest::Approx(p.at(p.stick_time() + 2).x).epsilon(1e-11));
}

TEST_CASE("Coulomb decay: turning points on time, stops exactly and stays") {
  const CoulombDecay p;
  const EventRecord record = tell(coulomb_decay(p), 40, 40);
  REQUIRE(record.events.size() == 7);
  for (std::size_t i = 0; i < 7; ++i)
    CHECK(record.events[i].t == doctest::Approx(static_cast<double>(i + 1) * std::numbers::pi).epsilon(1e-12));
  CHECK(record.events[6].kind == EventKind::stick);
  CHECK(record.run.final.q[0] == doctest::Approx(-0.2).epsilon(1e-11));
  CHECK(record.run.final.v[0] == 0);
}

TEST_CASE("impact oscillator: a disturbance has died out after 200 periods") {
  for (const double omega : {1.4, 1.6, 2.4}) {
    const ImpactOscillator p{.omega = omega, .disturbance = 1e-3};
    const EventRecord record = tell(impact_oscillator(p), 200.5 * p.period(), 200.5 * p.period());
    const auto impacts = record.of(EventKind::impact);
    REQUIRE(impacts.size() == 200);
    CHECK(std::abs(impacts.back().t - 200 * p.period()) <= 1e-10);
    CHECK(std::abs(impacts.back().normal / (1 + p.e) - p.impact_speed()) <= 1e-10);
  }
}

TEST_CASE("smooth references: pendulum and chains") {
  const Pendulum p;
  const EventRecord swing = tell(pendulum(p), 0.75 * p.period(), 1);
  const Motion exact = p.at(0.75 * p.period());
  CHECK(std::abs(swing.run.final.q[0] - std::sin(exact.x)) <= 1e-10);
  CHECK(swing.run.max_joint_residual <= 1e-12);
  for (const ChainExact& c : chain_exact()) {
    const EventRecord record = tell(chain({.links = c.links}), c.t, c.t);
    CHECK((record.run.final.q.tail<3>().head<2>() - Eigen::Vector2d(c.tip[0], c.tip[1])).norm() <= 1e-9);
    CHECK(record.run.max_joint_rate <= 1e-12);
  }
}

TEST_CASE("clearance at pin and guide: corners that strike in turn, ever faster, come to the impacts' own limit") {
  const Scene scene = read_scene(ORTHANT_ROOT "/core/scenes/slider_crank_both.toml");
  const auto crank = [&](std::string_view spec, double duration, double step) {
    const Run r = run_for(scene, duration, spec, step);
    REQUIRE_MESSAGE(r.status == Status::solved, r.why);
    return r.final.q[2];
  };
  // When the series is cut off must not matter: what is left of it may still be a third of its impulse.
  const double exact = crank(kScheme, 0.2, 0.2);
  CHECK(std::abs(crank("event-driven:accumulation=1e-12", 0.2, 0.2) - exact) <= 1e-6);
  CHECK(std::abs(crank("event-driven:accumulation=1e-11", 0.2, 0.01) - exact) <= 1e-6);
  const double soon = crank(kScheme, 0.06, 0.06);
  CHECK(std::abs(crank("adaptive:rtol=1e-6,atol=1e-8", 0.06, 0.06) - soon) <= 1e-6);
  CHECK(std::abs(crank("adaptive:rtol=1e-8,atol=1e-10", 0.2, 5e-4) - exact) <= 1e-2);  // crossings have a floor
  CHECK(std::abs(crank("adaptive:rtol=1e-5,atol=1e-7", 0.1, 1e-3) - crank(kScheme, 0.1, 0.1)) <= 1e-2);
}

TEST_CASE("loads that last shorter than the calls, by event-driven and adaptive") {
  Scene pulse;  // 1 kN at its peak, 0.5 N s in all
  pulse.body({.mass = 1, .inertia = 1});
  pulse.load(parse_scene(R"(
    [[body]]
    name = "body1"
    mass = 1
    inertia = 1
    [[load]]
    body = "body1"
    force = [1000, 0]
    factor = {type = "table", times = [0.7, 0.7005, 0.701], values = [0, 1, 0]}
  )")
                 .loads[0]);
  Scene jump = pulse;  // 3 N from t = 0.25 on
  jump.loads = {{.name = "on", .body = 0, .force = {3, 0}, .factor = [](double t) { return t >= 0.25 ? 1.0 : 0.0; }}};
  jump.loads[0].breakpoints = {0.25};
  for (const char* spec : {"event-driven", "adaptive"})
    for (const double step : {2.0, 0.25, 0.1}) {
      CAPTURE(spec);
      CAPTURE(step);
      const Run kicked = run_for(pulse, 2, spec, step), on = run_for(jump, 2, spec, step);
      CHECK(kicked.final.v[0] == doctest::Approx(0.5).epsilon(1e-12));
      CHECK(kicked.final.q[0] == doctest::Approx(0.5 * (2 - 0.7005)).epsilon(1e-12));
      CHECK(on.final.v[0] == doctest::Approx(3 * 1.75).epsilon(1e-12));
      CHECK(on.final.q[0] == doctest::Approx(1.5 * 1.75 * 1.75).epsilon(1e-12));
    }
}

TEST_CASE("event-driven steps allocate nothing once everything has been seen") {
  const System system(slider_crank({.mu = 0.1}));
  const auto scheme = make_integrator(kScheme, system);
  const auto solver = make_solver("lemke");
  State x = system.initial_state();
  for (int k = 0; k < 100; ++k) REQUIRE(scheme->step(1e-3, *solver, x).status == Status::solved);
  const auto before = AllocationCount::now();
  for (int k = 0; k < 100; ++k) scheme->step(1e-3, *solver, x);
  CHECK(AllocationCount::now() == before);
}

TEST_CASE("event-driven: same bits, a foreign state restarts, bad options are refused") {
  const auto angle = [] { return tell(slider_crank({.mu = 0.1, .omega3 = -0.01}), 0.02, 1e-3).run.final.q; };
  CHECK(angle() == angle());

  const System system(bouncing_ball());
  const auto scheme = make_integrator(kScheme, system);
  const auto solver = make_solver("lemke");
  State x = system.initial_state();
  REQUIRE(scheme->step(5, *solver, x).status == Status::solved);  // at rest, in lasting contact
  x.q[1] = 1, x.v[1] = 0;
  REQUIRE(scheme->step(0.1, *solver, x).status == Status::solved);
  CHECK(x.q[1] == doctest::Approx(1 - kGravity * 0.005));

  for (const char* option : {"rtol=0", "atol=-1", "max_events=0", "touching=1", "accumulation=-1", "first_step=-1"})
    CHECK_THROWS_AS(make_integrator(std::string(kScheme) + ":" + option, system), std::invalid_argument);
  const EventRecord few = tell(bouncing_ball({.e = 1}), 100, 100, "lemke", "event-driven:max_events=5");
  CHECK(few.run.status == Status::iteration_limit);
  CHECK(few.run.why.find("max_events") != std::string::npos);
  CHECK(few.events.size() <= 6);
}

TEST_CASE("collisions within one long step are detected: discs head-on, a turning box, by event-driven and adaptive") {
  Scene discs;
  for (const double x : {-1.0, 1.0}) {
    const auto disc = discs.body({.mass = 1, .inertia = 1, .position = {x, 0}, .velocity = {-20 * x, 0}});
    if (disc == 1) discs.contact(DiscDisc{"pair", 0, {0, 0}, 0.1, 1, {0, 0}, 0.1, {.e = 1}});
  }
  Scene box;  // the corner's speed is 100 rad/s times 0.1414 m, the wall 1 m away
  box.body({.mass = 1, .inertia = 1.0 / 600, .velocity = {2, 0}, .omega = 100});
  for (const Vector2d& corner : {Vector2d{0.1, 0.1}, Vector2d{-0.1, 0.1}, Vector2d{-0.1, -0.1}, Vector2d{0.1, -0.1}})
    box.contact(CornerWall{"", 0, corner, kGround, {1, 0}, {-1, 0}, {.e = 0.5}});
  for (const char* spec : {"event-driven", "adaptive"}) {
    CAPTURE(spec);
    const Run met = run_for(discs, 0.2, spec, 0.2);
    REQUIRE(met.status == Status::solved);
    CHECK(met.final.q[0] == doctest::Approx(-3.2).epsilon(1e-5));  // 0.9 m, then back at the same speed for 0.155 s
    CHECK(met.final.q[3] == doctest::Approx(3.2).epsilon(1e-5));
    const Run long_call = run_for(box, 0.6, spec, 0.6), short_calls = run_for(box, 0.6, spec, 1e-2);
    REQUIRE(long_call.status == Status::solved);
    CHECK(long_call.events > 0);
    CHECK((long_call.final.q - short_calls.final.q).norm() < 1e-4);
  }
}

TEST_CASE("a triangle's corner that passes through a box within a step strikes it, whatever the output step") {
  Scene s{.gravity = {0, 0}, .duration = 0.84};
  const auto a = s.body({.inertia = 0.1, .velocity = {2, 0}, .omega = -0.9130254192869451});
  const auto b = s.body({.mass = 3.9411570105838587,
                         .inertia = 0.3,
                         .position = {1.5, 0.16270567088306875},
                         .angle = 0.5591023822803454,
                         .velocity = {-1, 0},
                         .omega = -0.42560125448834407});
  s.contact_set(
      polygon_polygon({.a = a,
                       .corners_a = {{-0.5, -0.3}, {0.5, -0.3}, {0.5, 0.3}, {-0.5, 0.3}},
                       .b = b,
                       .corners_b = {{-0.4, -0.2}, {0.5, -0.25}, {0.1, 0.4}},
                       .law = {.mu = 0.08517459842784064, .e = 0.4017908467467865, .e_t = 0.48207663753853425}}));
  const auto fine = tell(s, s.duration, s.duration / 100);
  CHECK(fine.of(EventKind::impact).size() == 3);
  for (const double step : {0.84, 0.42, 0.21, 0.1}) {
    CAPTURE(step);
    const auto record = tell(s, s.duration, step);
    CHECK(record.of(EventKind::impact).size() == 3);
    CHECK((record.run.final.q - fine.run.final.q).lpNorm<Eigen::Infinity>() <= 1e-9);
  }
}

TEST_CASE("a disc rolls off the face of a tipping box onto its corner: the force jumps, and no step makes an impact") {
  Scene s{.gravity = {0, -9.81}, .duration = 0.1366863595248562};
  const double half = 0.12379186715899929;
  const ContactLaw law{.mu = 0.8, .e = 0.3};
  const BodyId box = s.body({.mass = 2.8076256782043307, .inertia = 0.028964801405111294, .position = {0, half}});
  const BodyId disc = s.body({.mass = 2.2625437588894273,
                              .inertia = 0.0348883228103045,
                              .position = {0.0765138308656916, 0.4231966890754168},
                              .velocity = {-2.3400545167981956, 0}});
  const std::vector<Vector2d> corners = {{-0.125, -half}, {0.125, -half}, {0.125, half}, {-0.125, half}};
  for (const Vector2d& corner : corners) s.contact(CornerWall{{}, box, corner, kGround, {0, 0}, {0, 1}, law});
  s.contact(DiscPolygon{{}, disc, {0, 0}, 0.17561295475741823, box, corners, law});
  const auto end = [&](const char* scheme, int steps) {
    const Run r = run(s, scheme, s.duration / steps);
    CHECK_MESSAGE(r.status == Status::solved, r.why);
    CHECK(r.crossings == 0);
    return r.final.q;
  };
  const Eigen::VectorXd coarse = end("event-driven", 4);
  for (const int steps : {140, 1120}) {
    CAPTURE(steps);
    CHECK((end("event-driven", steps) - coarse).lpNorm<Eigen::Infinity>() < 1e-8);
  }
  CHECK((end("adaptive:rtol=1e-8", 140) - coarse).lpNorm<Eigen::Infinity>() < 1e-6);
}
