// Event-driven integration against exact motions and the golden slider-crank, and what it does where there is none.
#include "tests/support/allocations.h"
#include "tests/support/runs.h"

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

namespace {

constexpr std::string_view kScheme = "event-driven";

struct Story {  // of a run: its events and sums of impulses
  Run run;
  std::vector<Event> events;
  std::vector<Impulse> sum;
  double tilt = 0;  // largest |θ| of the last body [rad]

  std::vector<Event> of(EventKind kind) const {
    std::vector<Event> found;
    std::copy_if(events.begin(), events.end(), std::back_inserter(found),
                 [&](const Event& e) { return e.kind == kind; });
    return found;
  }
};

Story tell(Scene scene, double duration, double step, std::string_view solver = "lemke",
           std::string_view scheme = kScheme) {
  Story story;
  scene.duration = duration;
  story.sum.resize(scene.contacts.size());
  story.run = run(
      scene, scheme, step,
      [&](const Moment& m) {
        story.events.insert(story.events.end(), m.events.begin(), m.events.end());
        for (std::size_t i = 0; i < story.sum.size(); ++i)
          story.sum[i].normal += m.impulses[i].normal, story.sum[i].tangent += m.impulses[i].tangent;
        story.tilt = std::max(story.tilt, std::abs(m.state.q[m.state.q.size() - 1]));
      },
      solver);
  return story;
}

struct Golden {
  double mu, e, omega3;
  std::string event;
  double t;
};

std::vector<Golden> golden_events() {
  std::ifstream in(ORTHANT_TEST_DATA "/slider_crank_events.csv");
  std::vector<Golden> events;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    Golden g;
    words >> g.mu >> g.e >> g.omega3 >> g.event >> g.t;
    events.push_back(g);
  }
  return events;
}

bool same_kind(const std::string& golden, EventKind kind) {
  if (golden == "impact") return kind == EventKind::impact || kind == EventKind::accumulation;
  if (golden == "release") return kind == EventKind::release;
  return kind == EventKind::slip || kind == EventKind::stick;
}

/// The largest relative distance of a golden event's time from the nearest one of the story.
double worst_time(const Story& story, double mu, double e, double omega3, int& count) {
  double worst = 0;
  for (const Golden& g : golden_events()) {
    if (g.mu != mu || g.e != e || g.omega3 != omega3) continue;
    double nearest = 1;
    for (const Event& event : story.events)
      if (same_kind(g.event, event.kind)) nearest = std::min(nearest, std::abs(event.t - g.t) / g.t);
    worst = std::max(worst, nearest);
    ++count;
  }
  return worst;
}

/// A rod's lower tip slides on the floor, in the sense in which friction presses it down.
Scene sliding_rod(double mu, double omega, double phi = std::atan(2.0)) {
  Scene s;
  s.gravity = {0, -kGravity};
  const auto rod = s.body({.name = "rod",
                           .mass = 1,
                           .inertia = 1.0 / 3,
                           .position = {std::cos(phi), std::sin(phi)},
                           .angle = phi,
                           .velocity = {-1 - omega * std::sin(phi), omega * std::cos(phi)},
                           .omega = omega});
  s.contact(CornerWall{"tip", rod, {-1, 0}, kGround, {0, 0}, {0, 1}, {.mu = mu}});
  return s;
}

}  // namespace

TEST_CASE("Dormand-Prince: a step of order 8, exact on what order 8 integrates") {
  // q'' = −q from (1, 0): the error of one step goes with h⁹.
  DormandPrince rk(1);
  const auto error = [&](double h) {
    Eigen::VectorXd q = Eigen::VectorXd::Ones(1), v = Eigen::VectorXd::Zero(1), a = -q, q_next(1), v_next(1);
    const auto f = [](double, const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& acceleration) {
      acceleration = -x;
      return true;
    };
    REQUIRE(rk.step(f, 0, q, v, a, h, q_next, v_next, [](double) {}));
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

TEST_CASE("slider-crank: every golden event to 1e-9, the crank's angle to 1e-9, joints to rounding") {
  for (const SliderCrankExact& exact : slider_crank_exact())
    for (const double step : {0.2, 2e-3}) {
      CAPTURE(exact.mu);
      CAPTURE(exact.e);
      CAPTURE(step);
      const bool sensitive = exact.e > 0.5 && exact.mu > 0.05;  // errors grow some 280 times in 0.2 s
      const Story story = tell(slider_crank({.mu = exact.mu, .e = exact.e}), 0.2, step);
      REQUIRE(story.run.status == Status::solved);
      int events = 0;
      const double worst = worst_time(story, exact.mu, exact.e, 0, events);
      const double theta1 = std::abs(story.run.final.q[kTheta1] - exact.theta1);
      MESSAGE("mu = " << exact.mu << ", e = " << exact.e << ", step " << step << ": " << events << " events to "
                      << worst << ", theta1 to " << theta1 << ", " << story.run.seconds * 1e3 << " ms");
      CHECK(events > 20);
      CHECK(worst <= (sensitive ? 1e-6 : 1e-9));
      CHECK(theta1 <= (sensitive ? 1e-6 : 1e-9));
      CHECK(std::abs(story.run.energy_final - exact.energy) <= 1e-9);
      CHECK(story.run.max_joint_residual <= 1e-12);
      CHECK(story.run.max_joint_rate <= 1e-12);
      CHECK(story.tilt <= 1e-12);
    }
}

TEST_CASE("slider-crank from a tilt: infinitely many alternate impacts within 1.6 microseconds are passed") {
  const Story story = tell(slider_crank({.omega3 = -0.01}), 0.2, 0.2);
  REQUIRE(story.run.status == Status::solved);
  CHECK(story.events.front().t == doctest::Approx(2.69090364840784e-3).epsilon(1e-12));
  CHECK(story.run.final.q[kTheta1] == doctest::Approx(18.0811239872).epsilon(1e-10 / 18));
  int events = 0;
  CHECK(worst_time(story, 0.01, 0.4, -0.01, events) <= 1e-9);
  CHECK(events > 80);
  const auto accumulation = story.of(EventKind::accumulation);
  REQUIRE(accumulation.size() > 2);
  CHECK(accumulation[0].t == doctest::Approx(2.6925481074359572e-3).epsilon(1e-9));
}

TEST_CASE("bouncing ball: passes the accumulation, rests exactly, all impulses counted") {
  for (const double e : {0.5, 0.9})
    for (const double step : {10.0, 0.01}) {
      CAPTURE(e);
      CAPTURE(step);
      const BouncingBall ball{.e = e};
      const Story story = tell(bouncing_ball(ball), 10, step);
      REQUIRE(story.run.status == Status::solved);
      const auto impacts = story.of(EventKind::impact), accumulation = story.of(EventKind::accumulation);
      REQUIRE(accumulation.size() == 1);
      CHECK(accumulation[0].t == doctest::Approx(ball.zeno_time()).epsilon(1e-12));
      double sum = accumulation[0].normal;
      for (std::size_t i = 0; i < impacts.size(); ++i) {
        sum += impacts[i].normal;
        CHECK(impacts[i].t == doctest::Approx(ball.impact_time(static_cast<int>(i) + 1)).epsilon(1e-12));
      }
      CHECK(sum == doctest::Approx(kGravity * ball.zeno_time()).epsilon(1e-6));  // what is left of the series is lost
      CHECK(story.sum[0].normal == doctest::Approx(kGravity * 10).epsilon(1e-12));  // but not to the contact
      CHECK(story.run.final.q[1] == 0);
      CHECK(story.run.final.v[1] == 0);
    }
  CHECK(tell(bouncing_ball(), 1.3, 1.3).run.final.q[1] == doctest::Approx(2.4163733329496484e-4).epsilon(1e-12));
}

TEST_CASE("elastic ball: ten thousand impacts keep the energy and their times") {
  const BouncingBall ball{.e = 1};
  const Story story = tell(bouncing_ball(ball), 9031, 9031);
  REQUIRE(story.events.size() == 10001);
  CHECK(story.events[9999].t == doctest::Approx(9030.0212960736324).epsilon(1e-12));
  CHECK(std::abs(story.run.energy_final / story.run.energy_initial - 1) <= 1e-12);
}

TEST_CASE("incline: sticks without creep, slides at the right rate, stops and turns back") {
  const double critical = std::tan(std::numbers::pi / 6);
  CHECK(std::abs(tell(incline({.mu = critical + 1e-6, .speed = 0}), 1, 0.1).run.final.v[0]) <= 1e-12);
  const double v = tell(incline({.mu = critical - 1e-6, .speed = 0}), 1, 0.1).run.final.v[0];
  CHECK(v == doctest::Approx(-kGravity * std::cos(std::numbers::pi / 6) * 1e-6).epsilon(1e-9));
  for (const Incline& p : {Incline{.mu = 0.5, .speed = 2}, Incline{.mu = 0.8, .speed = -2}}) {
    const Story story = tell(incline(p), 2, 2);
    REQUIRE(story.events.size() == 1);
    CHECK(story.events[0].kind == (p.speed > 0 ? EventKind::slip : EventKind::stick));
    CHECK(story.events[0].t == doctest::Approx(p.stop_time()).epsilon(1e-13));
    CHECK(story.run.final.q[0] == doctest::Approx(p.at(2).x).epsilon(1e-12));
    CHECK(std::abs(story.run.final.v[0] - p.at(2).v) <= 1e-12);
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
    const Story story = tell(s, 2, 0.5, solver);
    const Incline exact{.mu = mu, .speed = -2};
    REQUIRE(story.run.status == Status::solved);
    REQUIRE(story.events.size() == 2);
    CHECK(story.events[0].t == doctest::Approx(exact.stop_time()).epsilon(1e-12));
    CHECK(story.events[0].kind == EventKind::stick);
    CHECK(story.events[1].kind == EventKind::stick);
    CHECK(story.run.final.q[0] == doctest::Approx(exact.at(2).x).epsilon(1e-12));
    CHECK(std::abs(story.run.final.v[0]) <= 1e-12);
    const double weight = kGravity * std::cos(slope), pull = kGravity * std::sin(slope);
    CHECK(story.sum[0].normal + story.sum[1].normal == doctest::Approx(2 * weight).epsilon(1e-12));
    const double stop = exact.stop_time();
    CHECK(story.sum[0].tangent + story.sum[1].tangent ==
          doctest::Approx(mu * weight * stop + pull * (2 - stop)).epsilon(1e-11));
  }
}

TEST_CASE("stick-slip on a belt: both phases end on time, for ten periods") {
  const StickSlip p;
  const Story story = tell(stick_slip(p), 10 * p.period(), 1);
  REQUIRE(story.run.status == Status::solved);
  const auto slips = story.of(EventKind::slip), sticks = story.of(EventKind::stick);
  REQUIRE(slips.size() == 10);
  REQUIRE(sticks.size() >= 9);
  for (std::size_t i = 0; i < 9; ++i) {
    CHECK(slips[i].t == doctest::Approx(static_cast<double>(i) * p.period() + p.stick_time()).epsilon(1e-11));
    CHECK(sticks[i].t == doctest::Approx(static_cast<double>(i + 1) * p.period()).epsilon(1e-11));
  }
  const Story half = tell(stick_slip(p), p.stick_time() + 2, 1);
  CHECK(half.run.final.q[0] == doctest::Approx(p.at(p.stick_time() + 2).x).epsilon(1e-11));
}

TEST_CASE("Coulomb decay: turning points on time, stops exactly and stays") {
  const CoulombDecay p;
  const Story story = tell(coulomb_decay(p), 40, 40);
  REQUIRE(story.events.size() == 7);
  for (std::size_t i = 0; i < 7; ++i)
    CHECK(story.events[i].t == doctest::Approx(static_cast<double>(i + 1) * std::numbers::pi).epsilon(1e-12));
  CHECK(story.events[6].kind == EventKind::stick);
  CHECK(story.run.final.q[0] == doctest::Approx(-0.2).epsilon(1e-11));
  CHECK(story.run.final.v[0] == 0);
}

TEST_CASE("impact oscillator: a disturbance has died out after 200 periods") {
  for (const double omega : {1.4, 1.6, 2.4}) {
    const ImpactOscillator p{.omega = omega, .disturbance = 1e-3};
    const Story story = tell(impact_oscillator(p), 200.5 * p.period(), 200.5 * p.period());
    const auto impacts = story.of(EventKind::impact);
    REQUIRE(impacts.size() == 200);
    CHECK(std::abs(impacts.back().t - 200 * p.period()) <= 1e-10);
    CHECK(std::abs(impacts.back().normal / (1 + p.e) - p.impact_speed()) <= 1e-10);
  }
}

TEST_CASE("smooth references: pendulum and chains") {
  const Pendulum p;
  const Story swing = tell(pendulum(p), 0.75 * p.period(), 1);
  const Motion exact = p.at(0.75 * p.period());
  CHECK(std::abs(swing.run.final.q[0] - std::sin(exact.x)) <= 1e-10);
  CHECK(swing.run.max_joint_residual <= 1e-12);
  for (const ChainExact& c : chain_exact()) {
    const Story story = tell(chain({.links = c.links}), c.t, c.t);
    CHECK((story.run.final.q.tail<3>().head<2>() - Eigen::Vector2d(c.tip[0], c.tip[1])).norm() <= 1e-9);
    CHECK(story.run.max_joint_rate <= 1e-12);
  }
}

TEST_CASE("bars through the poses where all lie in one line, however often they are looked at") {
  for (const int loops : {1, 2, 3, 5})
    for (const double step : {10.0, 0.1, 1e-2, 1e-3}) {
      if (loops > 2 && step < 1e-2) continue;  // for time
      CAPTURE(loops);
      CAPTURE(step);
      const NFourBar bars{.loops = loops};
      const System system(n_four_bar(bars));
      double defect = 0;
      const Run r = run_for(n_four_bar(bars), 10, kScheme, step, [&](const Moment& m) {
        defect = std::max(defect, std::abs(energy(system, m.state) - bars.energy()));
      });
      REQUIRE(r.status == Status::solved);
      MESSAGE(loops << " loops, step " << step << ": angle off by " << r.final.q[2] + bars.at(10).x << ", energy by "
                    << r.energy_final - bars.energy() << " J, at worst " << defect << " J, " << r.seconds << " s");
      CHECK(std::abs(r.final.q[2] + bars.at(10).x) <= 1e-8);
      CHECK(std::abs(r.energy_final - bars.energy()) <= 2e-8);
      CHECK(defect <= 1e-6);
      CHECK(r.max_joint_residual <= 1e-11);
      CHECK(r.accepted <= 2000 + 12 / step);
    }
}

TEST_CASE("singular poses are passed with springs in the scene, and with more joint rows than the dense factor takes") {
  const auto end_of = [](const Scene& scene, double duration, double step) {
    const System system(scene);
    const Run r = run_for(scene, duration, kScheme, step);
    REQUIRE(r.status == Status::solved);
    CHECK(std::abs(r.energy_final - r.energy_initial) <= 1e-7);
    return r.final.q[2];
  };
  const NFourBar bars;
  Scene idle = n_four_bar(bars);  // a spring that does no work
  idle.spring(PointSpring{"idle", 0, kGround, {0, 0}, {0, 0}, 0, 0, 1});
  Scene apart = n_four_bar(bars);  // and one that works on a far body
  const BodyId far = apart.body({.mass = 1, .inertia = 1, .position = {50, 0}});
  apart.spring(PointSpring{"far", far, kGround, {0, 0}, {51, 0}, 30, 0, 0.5});
  for (const Scene& scene : {idle, apart}) CHECK(std::abs(end_of(scene, 10, 1e-2) + bars.at(10).x) <= 1e-7);
  const NFourBar eight{.loops = 8, .speed = 2};  // 50 joint rows: the sparse matrix
  CHECK(std::abs(end_of(n_four_bar(eight), 2, 1e-2) + eight.at(2).x) <= 1e-8);
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

TEST_CASE("a box pulled ever harder: both corners let go together, when friction is used up") {
  Scene s{.gravity = {0, -kGravity}};
  s.body({.mass = 1, .inertia = 1.0 / 150, .position = {0, 0.1}});
  for (const double x : {-0.1, 0.1}) s.contact(CornerWall{"", 0, {x, -0.1}, kGround, {0, 0}, {0, 1}, {.mu = 0.3}});
  for (const double rise : {1.0, 1e-9}) {  // [s] until 10 N; within the shorter times are known to 1e-7 of it only
    CAPTURE(rise);
    s.loads.clear();
    s.load({.name = "pull", .body = 0, .force = {10, 0}, .factor = [=](double t) {
              return std::clamp(t / rise, 0.0, 1.0);
            }});
    s.loads[0].breakpoints = {rise};
    const double slip = 0.3 * kGravity / 10;
    for (const double step : {2.0, 0.1}) {
      const Story story = tell(s, 2, step);
      REQUIRE(story.run.status == Status::solved);
      REQUIRE(story.events.size() == 2);
      for (const Event& e : story.events) {
        CHECK(e.kind == EventKind::slip);
        CHECK(e.t == doctest::Approx(slip * rise).epsilon(1e-6));
      }
      const double v = 5 * rise * (1 - slip) * (1 - slip) + 10 * (2 - rise) * (1 - slip);
      CHECK(story.run.final.v[0] == doctest::Approx(v).epsilon(1e-9));
    }
  }
}

namespace {

/// Discs fall between two walls 1 m apart; the fifth of 0.2 m on the floor jams the row.
Scene pile(int discs, double mu, double e) {
  Scene s{.gravity = {0, -kGravity}};
  const double r = 0.1;
  for (int i = 0; i < discs; ++i) {
    const int row = i / 4, column = i % 4;
    const double mass = 1 + 0.1 * i;
    s.body({.mass = mass,
            .inertia = mass * r * r / 2,
            .position = {-0.3 + 0.213 * column + 0.052 * row, 0.15 + 0.011 * i + 0.25 * row},
            .omega = mu > 0 ? i : 0.0});
    const ContactLaw law{.mu = mu, .e = e};
    s.contact(DiscWall{"", i, {0, 0}, r, kGround, {0, 0}, {0, 1}, law});
    s.contact(DiscWall{"", i, {0, 0}, r, kGround, {-0.5, 0}, {1, 0}, law});
    s.contact(DiscWall{"", i, {0, 0}, r, kGround, {0.5, 0}, {-1, 0}, law});
    for (int j = 0; j < i; ++j) s.contact(DiscDisc{"", i, {0, 0}, r, j, {0, 0}, r, law});
  }
  return s;
}

}  // namespace

TEST_CASE("piles come to rest, by event-driven and adaptive alike") {
  for (const char* spec : {"event-driven", "adaptive"}) {
    CAPTURE(spec);
    const Run smooth = run_for(pile(6, 0, 0.5), 2, spec, 0.1);
    REQUIRE_MESSAGE(smooth.status == Status::solved, smooth.why);
    // Five lie side by side from wall to wall, the sixth, of 1.4 kg, upon two of them.
    CHECK(smooth.energy_final == doctest::Approx(kGravity * (0.75 + 0.14 * std::sqrt(3.0))).epsilon(1e-6));
    CHECK(smooth.max_penetration <= 1e-6);
    const Run rough = run_for(pile(6, 0.3, 0.3), 2, spec, 0.1);
    REQUIRE(rough.status == Status::solved);
    CHECK(rough.energy_final > kGravity * 0.75);
    CHECK(rough.energy_final < 11);
    CHECK(rough.final.v.lpNorm<Eigen::Infinity>() <= 1e-3);
    CHECK(rough.max_penetration <= 1e-6);
    MESSAGE(std::string(spec) << ": " << smooth.seconds << " s, with friction " << rough.seconds << " s");
  }
}

TEST_CASE("Painlevé: a rod's tip has one solution, none, or several, and the run says which") {
  for (const std::string_view solver : {"lemke", "pgs", "enumerate"}) {
    CAPTURE(solver);
    const double h = 1e-6;
    const Story pressed = tell(sliding_rod(1, 0), h, h, solver);
    CHECK(pressed.sum[0].normal / h == doctest::Approx(24.525).epsilon(1e-5));
    const Story lifted = tell(sliding_rod(1, 4), h, h, solver);
    CHECK(lifted.run.status == Status::solved);
    CHECK(lifted.sum[0].normal == 0);
    const Story none = tell(sliding_rod(1.5, 0), h, h, solver);
    CHECK(none.run.status != Status::solved);
    CHECK(none.run.why.find("none") != std::string::npos);
    const Story several = tell(sliding_rod(1.5, 4), h, h, solver);
    CHECK(several.run.status == Status::unsupported);
    CHECK(several.run.why.find("several") != std::string::npos);
    CHECK(several.run.why.find("22.50417527999") != std::string::npos);
    CHECK(several.run.final.t == 0);
  }
}

TEST_CASE(
    "a disc falls into a groove: friction that jams it and restitution that throws it out contradict each other") {
  const auto fall = [](double mu, double e) {
    Scene s{.gravity = {0, -kGravity}};
    const auto disc = s.body({.name = "disc", .mass = 1, .inertia = 0.005, .position = {0, 0.5}});
    const double steep = 0.35;  // [rad] from the vertical: friction holds what lies there from its tangent on
    for (const double side : {-1.0, 1.0}) {
      const Vector2d normal(side * std::cos(steep), std::sin(steep));
      s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, {0, 0}, normal, {.mu = mu, .e = e}});
    }
    return tell(s, 0.5, 0.01);
  };
  const double jams = std::tan(0.35);
  CHECK(fall(0.99 * jams, 0.5).run.status == Status::solved);
  CHECK(fall(1.01 * jams, 0).run.status == Status::solved);
  const Story none = fall(1.01 * jams, 0.5);
  CHECK(none.run.status == Status::infeasible);
  CHECK(none.run.why.find("jamming") != std::string::npos);
  CHECK(none.run.final.t == doctest::Approx(std::sqrt(2 * (0.5 - 0.1 / std::sin(0.35)) / kGravity)).epsilon(1e-9));
}

TEST_CASE("a solver that gives up at an impact proves nothing, where walls without play contradict by rounding alone") {
  class GivesUp final : public Solver {
    Claim run(const Lcp&, Solution& s, Start) override {
      s.z.setZero();
      return Claim::stalled;
    }
    double tolerance() const override { return 1e-10; }
  } solver;
  int impacts = 0;
  for (int k = 1; k <= 40; ++k) {
    Scene s;
    const double angle = 0.1 * k;
    const Vector2d along(std::cos(angle), std::sin(angle)), across(-std::sin(angle), std::cos(angle));
    const auto disc = s.body({.name = "disc", .mass = 1, .inertia = 0.005, .velocity = 5 * along});
    const ContactLaw law{.mu = 0.1, .e = 0.5};
    s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, -0.1 * across, across, law});
    s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, 0.1 * across, (-(1 + 0.1 * k) * across).normalized(), law});
    s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, 1.1 * along, -along, law});
    const System system(s);
    const Run run = simulate(*make_integrator(kScheme, system), solver, {.step = 0.01, .duration = 0.5});
    CAPTURE(k);
    CHECK(run.status != Status::infeasible);
    impacts += run.why == "the impact was not solved";
  }
  CHECK(impacts > 20);
}

TEST_CASE("rocking block: impacts without slip on time, and it comes to rest") {
  const double b = 0.1, h = 0.4, radius = std::hypot(b, h), alpha = std::atan2(b, h), tilt = alpha / 2;
  Scene s;
  s.gravity = {0, -kGravity};
  // Tilted about the left lower corner, which lies in the origin.
  const double up = std::numbers::pi / 2 - alpha + tilt;
  const auto block = s.body({.name = "block",
                             .mass = 1,
                             .inertia = radius * radius / 3,
                             .position = {radius * std::cos(up), radius * std::sin(up)},
                             .angle = tilt});
  s.contact(CornerWall{"left", block, {-b, -h}, kGround, {0, 0}, {0, 1}, {.mu = 1}});
  s.contact(CornerWall{"right", block, {b, -h}, kGround, {0, 0}, {0, 1}, {.mu = 1}});
  const Story story = tell(s, 8, 1);
  REQUIRE(story.run.status == Status::solved);
  std::vector<double> times;
  for (const Event& e : story.of(EventKind::impact))
    if (times.empty() || e.t > times.back() + 1e-6) times.push_back(e.t);
  REQUIRE(times.size() > 10);
  const double exact[] = {0.31230857511262229, 0.82059222908260084, 1.251876744461843, 1.625866613309982};
  for (std::size_t i = 0; i < 4; ++i) CHECK(times[i] == doctest::Approx(exact[i]).epsilon(1e-10));
  CHECK(story.run.final.q[2] == doctest::Approx(0).epsilon(1e-10));
  CHECK(story.run.final.v.lpNorm<Eigen::Infinity>() <= 1e-12);
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
  const Story few = tell(bouncing_ball({.e = 1}), 100, 100, "lemke", "event-driven:max_events=5");
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

TEST_CASE("corners that strike together stay together, however often the run is looked at") {
  const Scene wide = slider_crank({.clearance = 0.01});
  const double theta1 = run_for(wide, 0.2, "event-driven", 0.2).final.q[2];
  for (const double step : {1e-2, 1e-3, 1e-4}) {
    const Run r = run_for(wide, 0.2, "event-driven", step);
    CAPTURE(step);
    CHECK(std::abs(r.final.q[2] - theta1) < 1e-9);
    CHECK(std::abs(r.final.q[8]) < 1e-11);
  }
}

TEST_CASE("blocks of mass 1, 1 and 1e6 stand: redundant contacts are no inconsistency") {
  for (const double mu : {0.0, 0.5}) {
    CAPTURE(mu);
    Scene s{.gravity = {0, -9.81}};
    const std::vector<Vector2d> square = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    const ContactLaw law{.mu = mu};
    for (int i = 0; i < 3; ++i) {
      const double mass = i < 2 ? 1 : 1e6;
      s.body({.mass = mass, .inertia = mass / 6, .position = {0, i + 0.5}});
    }
    for (const Vector2d& corner : {square[0], square[1]})
      s.contact(CornerWall{"", 0, corner, kGround, {0, 0}, {0, 1}, law});
    for (int i = 0; i < 2; ++i)
      for (const Vector2d& corner : {square[0], square[1]})
        s.contact(CornerWall{"", i + 1, corner, i, {0, 0.5}, {0, 1}, law});
    const Run r = run_for(s, 0.02, "event-driven", 0.01);
    INFO(r.why);
    CHECK(r.status == Status::solved);
    CHECK(r.final.v.lpNorm<Eigen::Infinity>() <= 1e-9);
  }
}

TEST_CASE("a box thrown up by a driven table stays level, however often the run is looked at") {
  Scene s{.gravity = {0, -kGravity}};
  s.body({.name = "table", .mass = 100, .inertia = 10});
  s.body({.name = "box", .mass = 1, .inertia = 1.0 / 150, .position = {0, 0.1}});
  s.joint(Prismatic{"guide", kGround, 0, {0, 0}, {0, 0}, {0, 1}});
  s.spring(PointSpring{"bed", kGround, 0, {0, -5}, {0, 0}, 1e5, 10, 5});
  s.load({.name = "drive", .body = 0, .force = {0, 3000}, .factor = [](double t) { return std::cos(20 * t); }});
  for (const double x : {-0.1, 0.1}) s.contact(CornerWall{"", 1, {x, -0.1}, 0, {0, 0}, {0, 1}, {.mu = 0.3, .e = 0.5}});
  for (const double step : {5.0, 0.1, 1e-2}) {
    const Run r = run_for(s, 5, kScheme, step);
    CAPTURE(step);
    REQUIRE(r.status == Status::solved);
    CHECK(std::abs(r.final.q[5]) < 1e-9);
    CHECK(r.final.q[4] == doctest::Approx(0.120587513).epsilon(1e-6));  // adaptive at 1e-9: 0.12058749
  }
}

TEST_CASE("friction redistributed repeatedly at one time: it ends as a crowd of events") {
  const Polygon plank = {{-0.3, -0.1}, {0.3, -0.1}, {0.3, 0.1}, {-0.3, 0.1}};
  const ContactLaw law{.mu = 1.5, .mu_static = 1.95};
  Scene s{.gravity = {0, -9.81}};
  const BodyId disc = s.body({.mass = 0.766,
                              .inertia = 0.0307,
                              .position = {0, 0.7},
                              .angle = -0.4766,
                              .velocity = {0.529, -1.053},
                              .omega = -4.215});
  const BodyId board = s.body({.mass = 0.573,
                               .inertia = 0.1051,
                               .position = {0.05, 0.15},
                               .angle = 0.2865,
                               .velocity = {-1.307, -1.724},
                               .omega = -4.782});
  s.contact_set(polygon_wall({.name = "floor", .a = board, .wall_point = {0, -0.5}, .law = law}, plank));
  s.contact(DiscPolygon{.name = "disc", .a = disc, .radius = 0.2, .b = board, .corners = plank, .law = law});
  const Run coarse = run_for(s, 0.4, kScheme, 0.01);
  REQUIRE(coarse.status == Status::solved);
  for (const double step : {1e-3, 1.5e-3}) {
    const Run fine = run_for(s, 0.4, kScheme, step);
    REQUIRE(fine.status == Status::solved);
    CHECK((fine.final.q - coarse.final.q).lpNorm<Eigen::Infinity>() <= 1e-10);
  }
}

TEST_CASE("a box's corner comes to the edge of another box: its normal jumps there, no velocity does") {
  const auto box = [](double x, double y) { return Polygon{{-x, -y}, {x, -y}, {x, y}, {-x, y}}; };
  const Polygon lower = box(0.31852913583277875, 0.24240270589579332),
                upper = box(0.22594898883315664, 0.16566352649908661);
  const ContactLaw law{.mu = 0.38899049574070471};
  Scene s{.gravity = {0, -9.81}};
  s.body({.mass = 1.5084387842771163,
          .inertia = 0.080560628107586518,
          .position = {-0.15733223164759308, 0.32864295135966332},
          .angle = 1.5278482063092722,
          .velocity = {-0.87180006373450325, -0.60615651709754947},
          .omega = 2.6527271013350129});
  s.body({.mass = 0.95068959020101795,
          .inertia = 0.024875537697188237,
          .position = {-0.10095706132862046, 0.83339687041986343},
          .angle = -0.14673138132570901,
          .velocity = {-0.55527520936132668, -0.94283611939874934},
          .omega = 4.6506000620929999});
  s.contact_set(polygon_wall({.name = "floor", .a = 0, .law = law}, lower));
  s.contact_set(polygon_polygon({.name = "pair", .a = 0, .corners_a = lower, .b = 1, .corners_b = upper, .law = law}));
  const Eigen::VectorXd exact = run_for(s, 0.013, "moreau-jean", 1e-6).final.q;  // to 1e-7
  for (const char* spec : {"event-driven", "event-driven:rtol=1e-8", "adaptive"})
    for (const double h : {0.013, 1e-3}) {
      CAPTURE(spec);
      CAPTURE(h);
      const Run r = run_for(s, 0.013, spec, h);
      REQUIRE(r.status == Status::solved);
      CHECK((r.final.q - exact).lpNorm<Eigen::Infinity>() <= 1e-6);
    }
}

TEST_CASE("redundant joints: the tolerance holds in one long step as in many, or it says why not") {
  Scene sliders{.gravity = {0, -9.81},
                .duration = 3};  // two on one rail, welded together, on a spring: x = sin(5 t) / 5
  const auto a = sliders.body({.inertia = 0.1, .velocity = {1, 0}});
  const auto b = sliders.body({.inertia = 0.1, .position = {1, 0}, .velocity = {1, 0}});
  sliders.joint(Prismatic{.a = kGround, .b = a});
  sliders.joint(Prismatic{.a = kGround, .b = b});
  sliders.joint(Fixed{.a = a, .b = b, .point_a = {1, 0}});
  sliders.spring(PointSpring{.a = kGround, .b = a, .point_a = {-10, 0}, .stiffness = 50, .rest = 10});
  Scene once{.gravity = {0, -9.81}, .duration = 3};  // a rod on a pin that is there twice
  const auto rod = once.body({.inertia = 1.0 / 12, .position = {0.5, 0}});
  once.joint(Revolute{.a = kGround, .b = rod, .point_b = {-0.5, 0}});
  Scene twice = once;
  twice.joint(Revolute{.a = kGround, .b = rod, .point_b = {-0.5, 0}});
  const auto simple = run(once, kScheme, once.duration).final.q;
  for (const double step : {3.0, 0.3, 0.01}) {
    CAPTURE(step);
    CHECK(std::abs(run(sliders, kScheme, step).final.q[0] - std::sin(15) / 5) <= 1e-9);
    CHECK((run(twice, kScheme, step).final.q - simple).lpNorm<Eigen::Infinity>() <= 1e-8);
  }

  Scene cranks{.gravity = {0, -9.81}, .duration = 1};  // four, parallel: in line at 0.75 s, where they may part
  const Vector2d along(std::cos(0.7), std::sin(0.7)), swing(-along.y(), along.x());
  for (int i = 0; i < 4; ++i)
    cranks.body(
        {.inertia = 1.0 / 12, .position = Vector2d(i, 0) + along / 2, .angle = 0.7, .velocity = swing, .omega = 2});
  const auto coupler = cranks.body({.mass = 2, .position = Vector2d(1.5, 0) + along, .velocity = 2 * swing});
  for (int i = 0; i < 4; ++i) {
    cranks.joint(Revolute{.a = kGround, .b = i, .point_a = {1.0 * i, 0}, .point_b = {-0.5, 0}});
    cranks.joint(Revolute{.a = i, .b = coupler, .point_a = {0.5, 0}, .point_b = {i - 1.5, 0}});
  }
  const double theta = run(cranks, "adaptive:rtol=1e-9", 1).final.q[2];
  for (const double step : {1.0, 0.1, 0.0033, 1e-3}) {
    CAPTURE(step);
    const Run r = run(cranks, kScheme, step);
    if (r.status == Status::solved)
      CHECK(std::abs(r.final.q[2] - theta) <= 1e-6);
    else
      CHECK(r.why.find("singular pose") != std::string::npos);
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
    const auto story = tell(s, s.duration, step);
    CHECK(story.of(EventKind::impact).size() == 3);
    CHECK((story.run.final.q - fine.run.final.q).lpNorm<Eigen::Infinity>() <= 1e-9);
  }
}
