// Painlevé's paradox in the storm of motions: states in which it is possible, and impacts without a solution.
#include "experiments/studies/motion_storm/judge.h"
#include "experiments/studies/motion_storm/painleve.h"
#include "experiments/studies/motion_storm/scenes.h"

#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace orthant::motion_storm {

TEST_CASE("motion storm: Painleve's paradox is possible for a rod with much friction, not a disc or a held corner") {
  const auto possible = [](double mu, double angle, double length) {
    Scene s{.gravity = {0, -10}};
    const Vector2d tip = length / 2 * Vector2d(std::cos(angle), std::sin(angle));
    s.body({.mass = 1, .inertia = length * length / 12, .position = -tip, .angle = angle});
    s.contact(CornerWall{{}, 0, {length / 2, 0}, kGround, {0, 0}, {0, 1}, {.mu = mu}});
    return painleve_possible(s, System(s).initial_state(), 1e-9);
  };
  // A uniform rod: 1 + 3 cos φ (cos φ − μ |sin φ|) < 0, for some φ from μ = 4/3 on.
  CHECK(possible(1.5, -1.1, 1));
  CHECK_FALSE(possible(1.3, -1.1, 1));
  CHECK_FALSE(possible(1.5, -0.1, 1));
  Scene disc{.gravity = {0, -10}};
  disc.body({.mass = 1, .inertia = 0.5, .position = {0, 1}});
  disc.contact(DiscWall{{}, 0, {0, 0}, 1, kGround, {0, 0}, {0, 1}, {.mu = 50}});
  CHECK_FALSE(painleve_possible(disc, System(disc).initial_state(), 1e-9));
  Scene held{.gravity = {0, -10}};
  held.body({.mass = 1, .inertia = 0.1, .position = {0.3, 0.4}});
  held.joint(Revolute{{}, kGround, 0, {0, 0}, {-0.3, -0.4}});
  held.contact(CornerWall{{}, 0, {-0.3, -0.4}, kGround, {0, 0}, {0, 1}, {.mu = 50}});
  CHECK_FALSE(painleve_possible(held, System(held).initial_state(), 1e-9));
}

TEST_CASE("motion storm: of many contacts with friction a paradox is looked for in pairs, or taken for possible") {
  const auto rods = [](int n, double mu) {  // each leans and slides on one end
    Scene s{.gravity = {0, -10}};
    for (int i = 0; i < n; ++i) {
      const int b = s.body({.mass = 1,
                            .inertia = 1.0 / 12,
                            .position = {2.0 * i, 0.5 * std::sin(1.2)},
                            .angle = 1.2,
                            .velocity = {-1, 0}});
      s.contact(CornerWall{{}, b, {-0.5, 0}, kGround, {0, 0}, {0, 1}, {.mu = mu}});
    }
    return s;
  };
  for (const int n : {1, 7}) {
    const Scene rough = rods(n, 2), smooth = rods(n, 0.1);
    CHECK(painleve_possible(rough, System(rough).initial_state(), 1e-9, false));
    CHECK_FALSE(painleve_possible(smooth, System(smooth).initial_state(), 1e-9, false));
    CHECK(painleve_possible(smooth, System(smooth).initial_state(), 1e-9, true) == (n > 6));
  }
}

TEST_CASE("motion storm: a wedged block's impact has no solution with friction and restitution, and one with less") {
  const auto block = [](double mu, double e) {  // one corner rests on a wall, the other strikes the wall opposite
    Scene s{.gravity = {0, -9.81}};
    s.body({.mass = 0.536, .inertia = 0.00815, .velocity = {0.00686, -0.05847}, .omega = -0.31885});
    const Vector2d rests{-0.1834, -0.0215}, strikes{0.2459, -0.0246};
    const double c = std::sqrt(0.5);
    s.contact(CornerWall{{}, 0, rests, kGround, rests, {c, c}, {.mu = mu}});
    s.contact(CornerWall{{}, 0, strikes, kGround, strikes, {-c, c}, {.mu = mu, .e = e}});
    return s;
  };
  const auto impossible = [](const Scene& s) { return impact_impossible(s, System(s).initial_state(), 1e-6); };
  CHECK(impossible(block(1.5, 0.6)));
  CHECK_FALSE(impossible(block(1.5, 0)));    // both corners stop
  CHECK_FALSE(impossible(block(0, 0.6)));    // without friction a solution always exists
  CHECK_FALSE(impossible(block(0.3, 0.6)));  // one slides
  Scene other = block(1.5, 0.6);
  other.restitution = Restitution::poisson;
  CHECK_FALSE(impossible(other));
  Scene apart = block(1.5, 0.6);
  std::get<CornerWall>(apart.contacts[0]).wall_point -= 1e-7 * Vector2d(1, 1);  // need not take part
  CHECK_FALSE(impossible(apart));
  for (const Verdict& v : judge(random_scene(2, 488).scene, {"event-driven", "adaptive"}, 488, {1, 30})) {
    INFO(v.integrator, ": ", v.why);
    CHECK((v.result == Result::stopped || v.result == Result::solved));
  }
}

TEST_CASE("motion storm: at a critical friction no impulse on the line of the singular equations solves an impact") {
  const auto disc = [](double mu) {
    Scene s{.gravity = {0, -9.81}};
    s.body({.mass = 1, .inertia = 0.03, .position = {0, 0.2 * std::numbers::sqrt2}, .velocity = {0, -0.3}});
    for (const double side : {1, -1})
      s.contact(DiscWall{{}, 0, {0, 0}, 0.2, kGround, {0, 0}, Vector2d(side, 1).normalized(), {.mu = mu, .e = 0.8}});
    return s;
  };
  const auto impossible = [](const Scene& s) { return impact_impossible(s, System(s).initial_state(), 1e-6); };
  CHECK(impossible(disc(1)));
  CHECK_FALSE(impossible(disc(0.9)));  // with ten times the impulse
}

TEST_CASE("motion storm: event-driven calls an impact of two corners infeasible just where that is proved") {
  std::mt19937_64 random(5);
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  int impossible = 0, other = 0;
  for (int k = 0; k < 400; ++k) {
    INFO(k);
    Scene s{.gravity = {0, -9.81}};
    s.body({.mass = 1, .inertia = draw(0.002, 0.03), .velocity = {draw(-1, 1), draw(-1, 0)}, .omega = draw(-5, 5)});
    for (const double side : {1, -1}) {
      const double angle = draw(0.2, 1.4);
      const Vector2d corner{-side * draw(0.1, 0.3), draw(-0.2, 0.1)}, normal{side * std::sin(angle), std::cos(angle)};
      s.contact(CornerWall{{}, 0, corner, kGround, corner, normal, {.mu = draw(0, 2), .e = draw(0, 1)}});
    }
    const System system(s);
    State x = system.initial_state();
    const bool proved = impact_impossible(s, x, 1e-6);
    const auto integrator = make_integrator("event-driven", system);
    const auto solver = make_solver("auto");
    const bool infeasible = integrator->step(1e-9, *solver, x).status == Status::infeasible;
    const bool later = !integrator->events().empty();  // something struck before the impact that has no solution
    CHECK((infeasible == proved || (infeasible && later)));
    other += infeasible && !proved;
    impossible += proved;
  }
  CHECK(impossible > 5);
  CHECK(other < 30);  // 13 seen
}

}  // namespace orthant::motion_storm
