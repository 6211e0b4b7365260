// Restitution where contacts last on curved paths, and where friction leaves impacts no solution.
#include "tests/support/runs.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace orthant;

TEST_CASE("stewart-trinkle: a taut rope pulls a body round in every step, with restitution too") {
  const double length = 1, speed = 5, h = 1e-3;
  for (const double e : {0.0, 0.2, 0.5, 0.8, 1.0}) {
    CAPTURE(e);
    Scene s{.gravity = {0, 0}, .duration = 0.5};
    const BodyId b = s.body({.mass = 2, .inertia = 0.1, .position = {length, 0}, .velocity = {0, speed}});
    s.contact(Limit{{}, Span{kGround, b, {0, 0}, {0, 0}}, Limit::Side::upper, length, {.e = e}});
    int steps = 0, slack = 0;
    double pull = 0, open = 0;
    const Run r = run(s, "stewart-trinkle", h, [&](const RunSample& m) {
      ++steps, slack += m.impulses[0].normal == 0;
      pull += m.impulses[0].normal, open = std::max(open, m.gaps[0]);
    });
    REQUIRE(r.status == Status::solved);
    CHECK(slack <= 2);  // the row of the start, and the first step
    CHECK(open < h * h * speed * speed / length);
    CHECK(pull / s.duration == doctest::Approx(2 * speed * speed / length).epsilon(0.02));
    CHECK(std::abs(r.final.q[0] - std::cos(speed * s.duration)) < 0.02);
    CHECK(steps > 400);
  }
}

namespace {

/// A corner of a turned box that falls into a steep wedge, one wall of which is rough and elastic.
Scene corner_in_wedge() {
  Scene s{.gravity = {0, -9.81}, .duration = 0.5};
  const BodyId b = s.body({.mass = 1, .inertia = 0.008, .position = {0, 0.7736}, .angle = -1.1});
  const Vector2d corner{0.137973661224488, -0.06311559442128316}, left{0.9805806756909202, 0.19611613513818404};
  s.contact(CornerWall{{}, b, corner, kGround, {0, 0}, left, {}});
  s.contact(CornerWall{{}, b, corner, kGround, {0, 0}, {-left.x(), left.y()}, {.mu = 0.5, .e = 0.5}});
  return s;
}

}  // namespace

TEST_CASE("friction that leaves Newton's law of impact no solution wins over restitution, and the run says so") {
  const Scene s = corner_in_wedge();
  int plastic = 0;
  for (const std::string scheme : {"stewart-trinkle", "paoli-schatzman", "moreau-jean"})
    for (const double h : {5e-3, 2e-3, 1e-3}) {
      CAPTURE(scheme);
      CAPTURE(h);
      const Run r = run(s, scheme, h, {}, "auto");
      INFO(r.why);
      CHECK(r.status == Status::solved);
      CHECK(r.energy_final <= r.energy_initial + 1e-3 * std::abs(r.energy_initial));
      CHECK((r.plastic_steps > 0) == (r.first_plastic_time < kInf));
      plastic += r.plastic_steps > 0;
    }
  CHECK(plastic > 2);
  Scene calm = s;  // no friction: there is always a solution
  std::get<CornerWall>(calm.contacts[1]).law.mu = 0;
  CHECK(run(calm, "stewart-trinkle", 5e-3, {}, "auto").plastic_steps == 0);
}

TEST_CASE("a step that friction leaves without a solution says so, and nothing of the motion") {
  Scene s{.gravity = {0, 0}, .duration = 0.1};  // a bar about its middle that meets a rough disc: Painlevé
  const BodyId b = s.body({.mass = 1, .inertia = 0.0473, .angle = 2, .omega = -40});
  s.joint(Revolute{{}, kGround, b, {0, 0}, {0, 0}});
  const Polygon bar{{-0.4321, -0.05}, {0.4321, -0.05}, {0.4321, 0.05}, {-0.4321, 0.05}};
  s.contact(DiscPolygon{{}, kGround, {0.36404, 0.2666}, 0.03, b, bar, {.mu = 2}});
  const Run r = run(s, "rattle", 1e-3, {}, "auto");
  CHECK(r.status == Status::stalled);
  CHECK(r.why.find("friction leaves the step's problem of 2 rows without a solution") != std::string::npos);
}
