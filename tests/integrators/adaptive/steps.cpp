// Promises of a step of the adaptive scheme: its length, its events and impulses, its end, the same bits twice.
#include "tests/integrators/adaptive/runs_to_tolerance.h"
#include "tests/support/allocations.h"
#include "tests/support/mechanics.h"

#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/slider_crank_exact.h>

#include <cmath>

using namespace orthant;

namespace {

/// A solver that gives up from its nth problem on.
class NeverSolves final : public Solver {
 public:
  explicit NeverSolves(int after) : left_(after), lemke_(make_solver("lemke")) {}

 private:
  Claim run(const Lcp& problem, Solution& s, Start) override {
    return left_-- > 0 ? handed_on(Solution(lemke_->solve(problem, s)), s) : Claim::stalled;
  }
  double tolerance() const override { return 1e-10; }
  int left_;
  std::unique_ptr<Solver> lemke_;
};

}  // namespace

TEST_CASE("the ball's impacts are reported, with the impulses that gravity asks for") {
  const BouncingBall p;
  std::vector<Event> events;
  double impulse = 0;
  run_to(bouncing_ball(p), 2, 1e-8, [&](const RunSample& m) {
    events.insert(events.end(), m.events.begin(), m.events.end());
    for (const Impulse& i : m.impulses) impulse += i.normal;
  });
  CHECK(impulse == doctest::Approx(2 * kGravity).epsilon(1e-9));
  REQUIRE(events.size() >= 10);
  for (int n = 0; n < 10; ++n) {
    CHECK(events[static_cast<std::size_t>(n)].kind == EventKind::impact);
    CHECK(std::abs(events[static_cast<std::size_t>(n)].t - p.impact_time(n + 1)) <= 1e-7);
    CHECK(events[static_cast<std::size_t>(n)].normal ==
          doctest::Approx((1 + p.e) * std::sqrt(2 * kGravity) * std::pow(p.e, n)).epsilon(1e-5));
  }
  CHECK(events.back().kind == EventKind::accumulation);
  CHECK(std::abs(events.back().t - p.zeno_time()) <= 1e-7);
}

TEST_CASE("a call advances by exactly h, and what is known of step sizes outlasts it") {
  const System system(slider_crank());
  const auto solver = make_solver("lemke");
  Adaptive whole(system), parts(system);
  State x = system.initial_state(), y = x;
  const StepReport once = whole.step(0.1, *solver, x);
  CHECK(x.t == 0.1);
  int accepted = 0;
  for (int k = 0; k < 50; ++k) {
    const double t = y.t;
    const StepReport report = parts.step(0.002, *solver, y);
    CHECK(y.t == t + 0.002);
    accepted += report.accepted;
  }
  CHECK(accepted <= 2 * once.accepted);
  CHECK((x.q - y.q).lpNorm<Eigen::Infinity>() <= 1e-5);

  State z = system.initial_state();  // another state starts again: the same as a new object
  whole.step(0.1, *solver, z);
  CHECK(z.q == x.q);
  CHECK(z.v == x.v);
}

TEST_CASE("a step that cannot go on keeps the last time reached, with a reason") {
  const System system(bouncing_ball({.e = 0.5}));
  const double first = BouncingBall{}.impact_time(1);
  {
    NeverSolves solver(0);
    Adaptive scheme(system);
    State x = system.initial_state();
    CHECK(scheme.step(1, solver, x).status == Status::stalled);
    CHECK(x.t == doctest::Approx(first).epsilon(1e-3));
    CHECK(x.q[1] == doctest::Approx(BouncingBall{}.at(x.t).x).epsilon(1e-9));
    CHECK(!scheme.why().empty());
    CHECK(scheme.problem().size() == 1);
  }
  const auto lemke = make_solver("lemke");
  Adaptive scheme(system, {.max_steps = 3});
  State x = system.initial_state();
  CHECK(scheme.step(1.3, *lemke, x).status == Status::iteration_limit);
  CHECK(x.t > first);
  CHECK(x.t < 1.3);
  CHECK(scheme.why().find("max_steps") != std::string::npos);
  while (x.t < 1.3) scheme.step(1.3 - x.t, *lemke, x);  // and the next call goes on from there
  CHECK(x.q[1] == doctest::Approx(BouncingBall{}.at(1.3).x).epsilon(1e-4));
  CHECK(scheme.why().empty());
}

TEST_CASE("boxes and balls fall, tumble and come to lie: energy falls, nothing sinks in") {
  testing::Draws random(5);
  for (int trial = 0; trial < 12; ++trial) {
    CAPTURE(trial);
    Scene s{.gravity = {0, -kGravity}};
    const ContactLaw law{.mu = random(0, 0.8), .e = random(0, 0.8)};
    for (int i = 0; i < 2; ++i) {
      const auto body = s.body({.inertia = 0.1,
                                .position = {random(-0.1, 0.1), 0.6 + 1.1 * i},
                                .angle = random(-0.5, 0.5),
                                .velocity = random.point(),
                                .omega = random(-3, 3)});
      for (const double x : {-0.4, 0.4})
        for (const double y : {-0.3, 0.3}) s.contact(CornerWall{"", body, {x, y}, kGround, {0, 0}, {0, 1}, law});
    }
    s.contact(DiscDisc{"", 0, {0, 0}, 0.5, 1, {0, 0}, 0.5, law});
    double before = kInf, rise = 0;
    const System system(s);
    const Run r = run_to(
        s, 1.5, 1e-5,
        [&](const RunSample& m) {
          const double now = energy(system, m.state);
          rise = std::max(rise, now - before), before = now;
        },
        0.02);
    CHECK(rise <= 1e-3);
    CHECK(r.max_penetration <= 1e-4);
    CHECK(r.accepted + r.rejected <= 20000);
  }
}

TEST_CASE("adaptive: with every solver a run is solved or ends with a reason") {
  const System system(slider_crank({.mu = 0.1}));
  const double theta1 = run_to(slider_crank({.mu = 0.1}), 0.01, 1e-7).final.q[kTheta1];
  for (const SolverEntry& entry : solvers()) {
    CAPTURE(entry.name);
    if (entry.name == "ipopt" || entry.name == "nlopt" || entry.name == "admm" || entry.name == "jacobi")
      continue;  // slow
    Adaptive scheme(system, {.rtol = 1e-4, .max_steps = 2000});
    const auto solver = make_solver(entry.name);
    State x = system.initial_state();
    const StepReport report = scheme.step(0.01, *solver, x);
    CHECK(scheme.why().empty() == (report.status == Status::solved));
    CHECK(x.q.allFinite());
    if (report.status != Status::solved) continue;
    CHECK(x.t == 0.01);
    CHECK(std::abs(x.q[kTheta1] - theta1) <= 1e-4);
  }
}

TEST_CASE("adaptive: no allocation after the first milliseconds, the same bits twice") {
  const System system(slider_crank({.mu = 0.1}));
  const auto solver = make_solver("lemke");
  Adaptive scheme(system, {.rtol = 1e-5});
  State x = system.initial_state();
  for (int k = 0; k < 100; ++k) scheme.step(1e-3, *solver, x);
  const auto before = AllocationCount::now();
  for (int k = 0; k < 100; ++k) scheme.step(1e-3, *solver, x);
  CHECK(AllocationCount::now() == before);

  const Run a = run_to(slider_crank({.mu = 0.1}), 0.2, 1e-4), b = run_to(slider_crank({.mu = 0.1}), 0.2, 1e-4);
  CHECK(a.final.q == b.final.q);
  CHECK(a.final.v == b.final.v);
}

TEST_CASE("adaptive: options out of range are refused") {
  const System system(bouncing_ball());
  CHECK_THROWS_WITH_AS(make_integrator("adaptive:rtol=2", system), doctest::Contains("[0, 1]"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(make_integrator("adaptive:atol=0", system), doctest::Contains("atol"), std::invalid_argument);
}

TEST_CASE("impulses balance the weight where a force jumps: a box on a belt is carried past the anchor of its spring") {
  constexpr double kMass = 2.0548, kBelt = -1.2474;
  Scene s{.gravity = {-2.968, -8.1278}, .duration = 0.4045};
  const BodyId box = s.body({.mass = kMass, .inertia = 0.00856, .position = {0, 0.05}});
  for (const double side : {-0.1, 0.1})
    s.contact(CornerWall{
        "", box, {side, -0.05}, kGround, {0, 0}, {0, 1}, {.mu = 0.7, .e = 0.2, .mu_static = 1.05, .belt = kBelt}});
  s.spring(PointSpring{
      .a = kGround, .b = box, .point_a = {-0.5, 0.05}, .point_b = {-0.1, 0}, .stiffness = 34.283, .rest = 0.4});
  const System system(s);
  for (const std::string_view spec : {"adaptive", "event-driven"}) {
    CAPTURE(spec);
    const auto scheme = make_integrator(spec, system);
    const auto solver = make_solver("lemke");
    double worst = 0, before = 0;
    const Run r = simulate(*scheme, *solver, {.step = 5e-3, .duration = s.duration}, [&](const RunSample& now) {
      double normal = 0;
      for (const Impulse& i : now.impulses) normal += i.normal;
      if (before > 0.01) worst = std::max(worst, std::abs(normal / (kMass * 8.1278 * (now.state.t - before)) - 1));
      before = now.state.t;
    });
    REQUIRE(r.status == Status::solved);
    CHECK(r.final.q[0] < -0.4);
    CHECK(worst < 1e-4);
  }
}
