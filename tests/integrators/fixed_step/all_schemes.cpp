// What holds for every fixed-step scheme: solvers, friction, allocations, options, starts.
#include "tests/integrators/fixed_step/thrown_disc.h"
#include "tests/support/allocations.h"
#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/oscillator.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/support/spline.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace orthant;

namespace {

class GivesUp final : public Solver {
  Claim run(const Lcp&, Solution&, Start) override { return Claim::stalled; }
  double tolerance() const override { return 1e-10; }
};

}  // namespace

TEST_CASE("elastic ball: moreau-jean keeps the energy over 1e6 steps; what the others do in 1e5") {
  const auto change = [](std::string_view spec, double duration) {
    const Run r = run_for(bouncing_ball({.e = 1}), duration, spec, 1e-3);
    REQUIRE(r.status == Status::solved);
    return (r.energy_final - r.energy_initial) / r.energy_initial;
  };
  CHECK(std::abs(change("moreau-jean", 1000)) <= 1e-12);
  for (const std::string_view spec : kFixedStep)  // an impact costs or gains them O(h) of height
    MESSAGE(spec << ": relative change of energy " << change(spec, 100));
}

TEST_CASE("the manners of a step, scheme by scheme") {
  for (const IntegratorEntry& entry : integrators()) {
    CAPTURE(entry.name);
    const System system(slider_crank({.mu = 0.1}));
    const auto solver = make_solver("lemke");

    SUBCASE("a state that is not the one returned last starts it anew, bit for bit") {
      const auto used = entry.make(system, ""), fresh = entry.make(system, "");
      State x = system.initial_state(), y = x;
      for (int k = 0; k < 100; ++k) used->step(1e-4, *solver, x);
      x = system.initial_state();
      for (int k = 0; k < 100; ++k) used->step(1e-4, *solver, x), fresh->step(1e-4, *make_solver("lemke"), y);
      CHECK(x.q == y.q);
      CHECK(x.v == y.v);
    }
    SUBCASE("a failed solve leaves the state as it was and keeps the problem") {
      const System ball(bouncing_ball());
      const auto scheme = entry.make(ball, "");
      GivesUp gives_up;
      State x = ball.initial_state();
      x.q[1] = 0, x.v << 1, -2, 3;
      const State before = x;
      CHECK(scheme->step(1e-3, gives_up, x).status == Status::stalled);
      CHECK(x.t == before.t);
      CHECK(x.q == before.q);
      CHECK(x.v == before.v);
      REQUIRE(scheme->problem().size() >= 1);
      Solution replay;
      CHECK(solver->solve(scheme->problem(), replay).status == Status::solved);
      x.q[1] = 5;
      REQUIRE(scheme->step(1e-3, gives_up, x).status == Status::solved);
      CHECK(scheme->problem().size() == 0);  // not the one before

      const Run r = simulate(*scheme, gives_up, {.step = 1e-3, .duration = 1, .every = 1});
      CHECK(r.status == Status::stalled);
      CHECK(r.final.t < 1);
    }
    SUBCASE("a step much too long ends with a status, never with a joint that is open") {
      const auto scheme = entry.make(system, "");
      State x = system.initial_state();
      for (const double h : {3e-3, 1e-2, 0.1, 10.0}) {
        x = system.initial_state();
        for (int k = 0; k < 20; ++k) {
          const StepReport report = scheme->step(h, *solver, x);
          if (report.status != Status::solved) break;
          CHECK(report.joint_residual < 1e-6);
        }
        CHECK(x.q.allFinite());
        CHECK(x.v.allFinite());
      }
    }
  }
}

TEST_CASE("any solver may be given to any scheme: the same motion, or a status and the state as it was") {
  const System system(slider_crank({.mu = 0.1}));
  for (const std::string_view spec : kFixedStep) {
    const auto scheme = make_integrator(spec, system);
    const auto lemke = make_solver("lemke");
    State start = system.initial_state();
    for (int k = 0; k < 25; ++k) REQUIRE(scheme->step(1e-4, *lemke, start).status == Status::solved);
    State expected = start;  // past the first impact, of two corners at once
    for (int k = 0; k < 5; ++k) REQUIRE(scheme->step(1e-4, *lemke, expected).status == Status::solved);
    int solved = 0;
    for (const SolverEntry& entry : solvers()) {
      CAPTURE(spec);
      CAPTURE(entry.name);
      const auto solver = make_solver(entry.name);
      solver->set_time_limit(1);
      State x = start;
      int steps = 0;
      for (; steps < 5; ++steps) {
        const State before = x;
        if (scheme->step(1e-4, *solver, x).status == Status::solved) continue;
        CHECK(x.q == before.q);
        CHECK(x.v == before.v);
        break;
      }
      if (steps < 5) continue;
      ++solved;
      CHECK((x.q - expected.q).lpNorm<Eigen::Infinity>() < 1e-6);
    }
    MESSAGE(spec << ": " << solved << " solvers");
    CHECK(solved >= 15);
  }
}

TEST_CASE("static friction and moving surfaces mean the same to every scheme") {
  for (const std::string_view spec : kFixedStep) {
    CAPTURE(spec);
    for (const double speed : {0.0, 1.0}) {
      if (spec == "anitescu-potra" && speed > 0) continue;           // its problem is solved once: see formulate.h
      const Incline p{.mu = 0.3, .mu_static = 0.6, .speed = speed};  // tan 30° = 0.577
      const Run r = run_for(incline(p), 2, spec, 1e-3);
      CHECK(std::abs(r.final.v[0]) <= 1e-12);
      CHECK(std::abs(r.final.q[0] - p.at(2).x) < 2e-3);
    }
    Scene moving = incline({.mu = 0.5, .speed = 2}), resting = incline({.mu = 0.5, .speed = 1.3});
    std::get<CornerWall>(moving.contacts[0]).law.belt = 0.7;
    const Run a = run_for(moving, 1, spec, 1e-3), b = run_for(resting, 1, spec, 1e-3);
    CHECK(a.final.v[0] == doctest::Approx(b.final.v[0] + 0.7).epsilon(1e-11));
    CHECK(a.final.q[0] == doctest::Approx(b.final.q[0] + 0.7).epsilon(1e-11));
  }
}

TEST_CASE("forty balls side by side move as one does, their problem as an operator") {
  for (const std::string_view spec : kFixedStep) {
    CAPTURE(spec);
    const Scene one = thrown_disc({.mu = 0.2, .e = 0.5}, 0.1, {1, 0}, 2, kGravity);
    Scene many = one;
    for (int i = 1; i < 40; ++i) {
      const auto b = many.body(one.bodies[0]);
      many.bodies.back().name = "ball" + std::to_string(i);
      many.bodies.back().position.x() += 2 * i;
      many.contact(DiscWall{"", b, {0, 0}, 0.5, kGround, {0, 0}, {0, 1}, {.mu = 0.2, .e = 0.5}});
    }
    const Run a = run_for(one, 0.5, spec, 1e-3), b = run_for(many, 0.5, spec, 1e-3);
    REQUIRE(b.status == Status::solved);
    const System system(many);
    for (int i = 0; i < 40; ++i) {
      Eigen::Vector3d off = b.final.q.segment<3>(3 * i) - a.final.q;
      off.x() -= 2 * i;
      CHECK(off.lpNorm<Eigen::Infinity>() < 1e-11);
      CHECK((b.final.v.segment<3>(3 * i) - a.final.v).lpNorm<Eigen::Infinity>() < 1e-9);
    }
  }
}

TEST_CASE("the step loop of every scheme allocates nothing after its first steps") {
  std::vector<std::string_view> specs(std::begin(kFixedStep), std::end(kFixedStep));
  specs.insert(specs.end(), {"moreau-jean:joints=position", "moreau-jean:form=full"});
  for (const std::string_view spec : specs)
    for (const char* lcp : {"lemke", "pgs"}) {
      CAPTURE(spec);
      CAPTURE(lcp);
      const System system(slider_crank({.mu = 0.1}));
      const auto scheme = make_integrator(spec, system);
      const auto solver = make_solver(lcp);
      State x = system.initial_state();
      for (int k = 0; k < 400; ++k) scheme->step(1e-5, *solver, x);  // past the first impact
      const auto before = AllocationCount::now();
      for (int k = 0; k < 2000; ++k) scheme->step(1e-5, *solver, x);
      CHECK(AllocationCount::now() == before);
    }
}

TEST_CASE("options outside their range are refused by name") {
  const System system(bouncing_ball());
  CHECK_THROWS_WITH_AS(make_integrator("generalized-alpha:rho_inf=1.5", system), doctest::Contains("rho_inf = 1.5"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(make_integrator("rattle:theta=1", system), doctest::Contains("theta"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(make_integrator("moreau-jean:theta=0.5,theta=0.6", system),
                       doctest::Contains("'theta=0.6': is given twice"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(make_integrator("stewart-trinkle:joints=soft", system), doctest::Contains("symmetric"),
                       std::invalid_argument);
}

TEST_CASE("a start that breaks its joints is moved onto them, the same way by all") {
  Scene scene{.gravity = {0, -9.81}};
  const BodyId rod = scene.body(
      {.mass = 1, .inertia = 1.0 / 12, .position = {0.6, 0.1}, .velocity = {0.3, 1}, .omega = 1});  // 0.14 m off
  scene.joint(Revolute{"pin", kGround, rod, {0, 0}, {-0.5, 0}});
  const double h = 1e-4, duration = 0.5;
  const Run exact = run_for(scene, duration, "adaptive:rtol=1e-9", 0.1);
  CHECK(exact.max_joint_residual <= 1e-11);  // between inner steps: a hundredth of the tolerance
  for (const IntegratorEntry& entry : integrators()) {
    CAPTURE(entry.name);
    const Run r = run_for(scene, duration, entry.name, h);
    CHECK(r.status == Status::solved);
    CHECK((r.final.q - exact.final.q).lpNorm<Eigen::Infinity>() <= 1e-3);
  }
}

TEST_CASE("joints that a step leaves open end the run, however long its path was") {
  Scene scene;
  const BodyId wheel = scene.body({.name = "wheel", .mass = 1, .inertia = 1});
  scene.joint(Revolute{"pin", kGround, wheel});
  scene.joint(Drive{"drive", Angle{kGround, wheel}, {.table = Spline({0, 1e-30, 1}, {0, 1e-3, 1})}});
  for (const std::string_view scheme :
       {"moreau-jean", "stewart-trinkle", "paoli-schatzman", "rattle", "generalized-alpha"}) {
    CAPTURE(scheme);
    const Run r = run_for(scene, 1, scheme, 1e-2);
    if (r.status == Status::solved) CHECK(r.final.q[2] == doctest::Approx(1).epsilon(1e-6));
  }
}

TEST_CASE(
    "oscillator: schemes that move by the end velocity are bounded at any step, with the force of the mean position") {
  for (const std::string_view scheme : {"stewart-trinkle", "anitescu-potra", "paoli-schatzman"})
    for (const double wh : {0.2, 1.9, 3.0, 100.0, 1e4}) {
      CAPTURE(scheme);
      CAPTURE(wh);
      const double h = 1e-2, x = 0.3, v = -0.7, w2 = wh * wh / (h * h);
      Scene s;
      const auto b = s.body({.name = "mass", .mass = 1, .inertia = 1, .position = {x, 0}, .velocity = {v, 0}});
      s.spring(PointSpring{"spring", b, kGround, {0, 0}, {-5, 0}, w2, 0, 5});
      const Run once = run_for(s, h, scheme, h);
      const double after = (v - w2 * h * x) / (1 + wh * wh / 2);  // v⁺ − v = −ω²h (x + x⁺)/2,  x⁺ = x + h v⁺
      CHECK(once.final.v[0] == doctest::Approx(after).epsilon(1e-9));
      CHECK(once.final.q[0] == doctest::Approx(x + h * after).epsilon(1e-9));
      const Run many = run_for(s, 1000 * h, scheme, h);
      CHECK(many.energy_final <= 1.01 * many.energy_initial);
    }
}

TEST_CASE(
    "generalized-alpha: a driven four-bar with a clearance pin, at steps whose corrections are as long as the "
    "clearance") {
  Scene s = read_scene(ORTHANT_ROOT "/tests/data/four_bar_clearance.toml");
  s.loads.clear();
  s.joint(Drive{"motor", Angle{kGround, 0}, TimeLaw{.offset = std::numbers::pi / 2, .rate_of_change = 20}});
  const double right = run_for(s, 0.1, "event-driven", 0.01).final.q[8];
  for (const double h : {2e-4, 1e-4}) {
    CAPTURE(h);
    const Run r = run_for(s, 0.1, "generalized-alpha", h);
    CHECK_MESSAGE(r.status == Status::solved, r.why);
    CHECK(std::abs(r.final.q[8] - right) <= 10 * h);
  }
}
