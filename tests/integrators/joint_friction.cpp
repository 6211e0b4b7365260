// Dry friction in joints and searched collisions, by integrators that follow every contact: closed forms.
#include "tests/support/runs.h"

#include <orthant/core/scenes/pile.h>

#include <algorithm>
#include <numbers>

using namespace orthant;

namespace {

constexpr const char* kFollowers[] = {"event-driven", "adaptive:rtol=1e-9"};

/// A block of 1 kg on a level rail with the dry friction `bound` [N], on a spring of 1 N/m if it is to have one.
Scene block(double x, double v, double bound, bool spring) {
  Scene s;
  s.body({.name = "block", .mass = 1, .inertia = 1, .position = {x, 0}, .velocity = {v, 0}});
  s.joint(Prismatic{"rail", kGround, 0, {0, 0}, {0, 0}, {1, 0}, 0});
  s.friction({.name = "grip", .of = Slide{kGround, 0, {0, 0}, {0, 0}, {1, 0}}, .bound = bound});
  if (spring) s.spring(JointSpring{"", Slide{kGround, 0, {0, 0}, {0, 0}, {1, 0}}, 1, 0, 0});
  return s;
}

}  // namespace

TEST_CASE("a block on a rail with dry friction stops exactly where and when it must, and stays") {
  for (const char* integrator : kFollowers) {
    CAPTURE(integrator);
    Scene s = block(0, 3, 2, false);
    s.duration = 4;
    double stop = -1, impulse = 0;
    const Run r = run(s, integrator, 0.1, [&](const RunSample& m) {
      impulse += m.frictions[0];
      for (const Event& e : m.events)
        if (e.kind == EventKind::stick && e.contact == 0) stop = e.t;  // behind all contacts, of which there are none
    });
    REQUIRE(r.status == Status::solved);
    CHECK(stop == doctest::Approx(1.5).epsilon(1e-7));
    CHECK(r.final.q[0] == doctest::Approx(2.25).epsilon(1e-7));
    CHECK(std::abs(r.final.v[0]) < 1e-12);
    CHECK(impulse == doctest::Approx(-3).epsilon(1e-7));
  }
}

TEST_CASE("Coulomb decay by a joint's friction: 10, -8.6, 7.2, -5.8, 4.4, -3, 1.6, -0.2, and rest") {
  for (const char* integrator : kFollowers) {
    CAPTURE(integrator);
    Scene s = block(10, 0, 0.7, true);
    s.duration = 9 * std::numbers::pi;
    std::vector<double> turns;
    const Run r = run(s, integrator, std::numbers::pi, [&](const RunSample& m) { turns.push_back(m.state.q[0]); });
    REQUIRE(r.status == Status::solved);
    const std::vector<double> right = {10, -8.6, 7.2, -5.8, 4.4, -3, 1.6, -0.2, -0.2, -0.2};
    REQUIRE(turns.size() == right.size());
    for (std::size_t i = 0; i < right.size(); ++i) CHECK(std::abs(turns[i] - right[i]) < 1e-6);
  }
}

TEST_CASE("a pendulum with dry friction in its pin: the energy that each swing loses is the torque times its angle") {
  for (const char* integrator : kFollowers) {
    CAPTURE(integrator);
    Scene s;
    s.gravity = {0, -9.81};
    s.body({.name = "bob", .mass = 2, .inertia = 0.1, .position = {1, 0}});
    s.joint(Revolute{"pin", kGround, 0, {0, 0}, {-1, 0}});
    s.friction({.name = "pin", .of = Angle{kGround, 0}, .bound = 1.5});
    s.duration = 60;
    double last = 0, rate = -1;
    std::vector<double> turns = {0};
    const Run r = run(s, integrator, 1e-2, [&](const RunSample& m) {
      const double theta = m.state.q[2], omega = m.state.v[2];
      if (omega * rate < 0) turns.push_back(std::abs(theta) > std::abs(last) ? theta : last);
      if (omega != 0) rate = omega;
      last = theta;
    });
    REQUIRE(r.status == Status::solved);
    REQUIRE(turns.size() > 5);
    const auto height = [](double theta) { return 2 * 9.81 * std::sin(theta); };
    for (std::size_t i = 1; i < turns.size(); ++i) {
      const double lost = height(turns[i - 1]) - height(turns[i]);
      CHECK(lost == doctest::Approx(1.5 * std::abs(turns[i] - turns[i - 1])).epsilon(5e-3));
    }
    CHECK(std::abs(r.final.v[2]) < 1e-9);                              // it has stopped
    CHECK(std::abs(2 * 9.81 * std::cos(r.final.q[2])) <= 1.5 + 1e-6);  // where friction holds it
  }
}

TEST_CASE("event-driven and adaptive: a collision is all its pairs listed") {
  Scene s;
  s.gravity = {0, -9.81};
  s.collision({.name = "discs", .shapes = {}, .law = {.mu = 0.2, .e = 0.6}, .neighbours = 3});
  for (int i = 0; i < 4; ++i) {
    const BodyId disc = s.body({.mass = 1 + 0.1 * i, .inertia = 0.004, .position = {0.13 * i, 0.4 + 0.25 * (i % 2)}});
    s.collisions[0].shapes.push_back({disc, {0, 0}, 0.1, {}});
    s.contact(DiscWall{"", disc, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.e = 0.6}});
  }
  s.duration = 0.4;
  for (const char* integrator : {"event-driven", "adaptive"}) {
    CAPTURE(integrator);
    double pushed = 0, listed_push = 0, deepest = 0;
    int strange = 0;
    const int contacts = System(s).contacts();
    const Run found = run(s, integrator, 1e-2, [&](const RunSample& m) {
      for (const Impulse& p : m.impulses) pushed += p.normal;
      for (const Event& e : m.events) strange += e.contact < 0 || e.contact >= contacts;
      for (Index i = 0; i < m.gaps.size(); ++i) deepest = std::min(deepest, m.gaps[i]);
    });
    const Run listed = run(with_pairs_listed(s), integrator, 1e-2, [&](const RunSample& m) {
      for (const Impulse& p : m.impulses) listed_push += p.normal;
    });
    REQUIRE(found.status == Status::solved);
    CHECK(found.final.q == listed.final.q);
    CHECK(found.events == listed.events);
    CHECK(found.events > 4);
    CHECK(pushed == doctest::Approx(listed_push).epsilon(1e-12));
    CHECK(pushed > 1);
    CHECK(strange == 0);
    CHECK(deepest > -1e-6);
  }
}

TEST_CASE("event-driven and adaptive refuse unsupported joint friction with a reason") {
  const System crowd(pile({.discs = 60}));
  Scene loaded = block(0, 1, 0.1, false);
  loaded.frictions[0].mu = 0.1, loaded.frictions[0].joint = 0;
  const System bearing(loaded);
  for (const char* integrator : {"event-driven", "adaptive"}) {
    CHECK_THROWS_WITH_AS(make_integrator(integrator, crowd), doctest::Contains("must be 1000 in all"),
                         std::invalid_argument);
    CHECK_THROWS_WITH_AS(make_integrator(integrator, bearing), doctest::Contains("mu must be 0"),
                         std::invalid_argument);
  }
}
