// Impacts in turn: two contacts that strike alternately, ever faster, end alike wherever the scene lies.
#include "tests/support/runs.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/integrators/between_events/impact_series.h>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>

using namespace orthant;

namespace {

/// A heavy rod, and a light one hinged to it, which strikes a limit of its angle and the floor in turn.
Scene rods(const Vector2d& origin) {
  Scene s{.gravity = {0, -9.81}};
  const auto heavy = s.body({.inertia = 0.01, .position = origin + Vector2d(0.4, 1), .angle = 0.7});
  const auto light = s.body({.mass = 0.007, .inertia = 5e-5, .position = origin + Vector2d(0.7, 1), .angle = -0.3});
  s.joint(Revolute{{}, heavy, light, {0.20948790080755697, 0}, {-0.13932063200183975, 0}});
  s.contact(Limit{{}, Angle{heavy, light}, Limit::Side::upper, -0.4645386876152957, {.e = 0.5}});
  s.contact(CornerWall{
      {}, light, {0.1393206320018397, 0}, kGround, origin + Vector2d(0, 0.6851341298029153), {0, 1}, {.e = 0.5}});
  s.duration = 0.6;
  return s;
}

}  // namespace

TEST_CASE("impacts in turn: their end depends neither on the place of the scene nor on where the series is cut off") {
  const auto end = [](const Vector2d& origin, const char* scheme) {
    const Run r = run(rods(origin), scheme, 0.6 / 140);
    REQUIRE_MESSAGE(r.status == Status::solved, r.why);
    CHECK(r.crossings == 0);
    return std::array{r.final.q[2], r.final.q[5]};
  };
  const auto here = end({0, 0}, "event-driven");
  const auto same = [&](const std::array<double, 2>& other) {
    CHECK(std::abs(other[0] - here[0]) < 1e-8);
    CHECK(std::abs(other[1] - here[1]) < 1e-8);
  };
  for (const Vector2d& origin : {Vector2d(3.1, -1.7), Vector2d(-12, 0.3), Vector2d(0.1, 40)})
    same(end(origin, "event-driven"));
  same(end({0, 0}, "event-driven:accumulation=1e-12"));
}

TEST_CASE("a body that strikes at the instant at which another one's series of impacts ends rebounds by its own law") {
  // Two balls far apart. One bounces with e = 1/2; the other falls to the floor at the other's k-th impact.
  const double g = 9.81, height = 0.3, first = std::sqrt(2 * height / g);
  for (int k = 2; k < 40; ++k) {
    CAPTURE(k);
    double t = first;
    for (int i = 1; i < k; ++i) t += 2 * first * std::pow(0.5, i);
    Scene s{.gravity = {0, -g}, .duration = 1.1 * t};
    const BodyId bouncing = s.body({.inertia = 0.01, .position = {0, 0.1 + height}});
    const BodyId falling = s.body({.inertia = 0.01, .position = {1, 0.1 + g * t * t / 2}});
    s.contact(DiscWall{{}, bouncing, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.e = 0.5}});
    s.contact(DiscWall{{}, falling, {0, 0}, 0.1, kGround, {0, 0}, {0, 1}, {.e = 0.8}});
    const Run r = run(s, "event-driven", s.duration);
    REQUIRE_MESSAGE(r.status == Status::solved, r.why);
    const double since = 0.1 * t;
    CHECK(std::abs(r.final.q[4] - (0.1 + 0.8 * g * t * since - g * since * since / 2)) < 1e-9);
  }
}

TEST_CASE("impacts in turn: a series is four impacts at shrinking intervals, not three") {
  ImpactSeries series;
  for (const double t : {0.0, 1.0, 1.1}) {
    series.add(t);
    CHECK_FALSE(series.accumulates());
  }
  series.add(1.11);
  CHECK(series.accumulates());
  CHECK(series.rest == doctest::Approx(0.01 / 9));
}

TEST_CASE("impacts in turn: a light disc crushed between a heavy one and the floor leaves as fast by any tolerance") {
  Scene s{.gravity = {0, -9.81}, .duration = 0.6};
  const ContactLaw law{.mu = 0.1, .e = 0.8};
  const BodyId light = s.body({.mass = 1, .inertia = 0.02, .position = {0, 0.21}});
  const BodyId heavy = s.body({.mass = 1000, .inertia = 0.02, .position = {-0.0313, 0.7273}});
  for (const BodyId disc : {light, heavy}) s.contact(DiscWall{{}, disc, {0, 0}, 0.2, kGround, {0, 0}, {0, 1}, law});
  s.contact(DiscDisc{{}, light, {0, 0}, 0.2, heavy, {0, 0}, 0.2, law});
  const Run sharp = run(s, "event-driven", 1e-2), rough = run(s, "adaptive:rtol=1e-9", 1e-2);
  for (const Run* r : {&sharp, &rough}) {
    CHECK(r->status == Status::solved);
    CHECK(r->crossings == 0);
  }
  CHECK(sharp.final.q[0] > 5);
  CHECK((sharp.final.q - rough.final.q).lpNorm<Eigen::Infinity>() < 1e-6);
}

TEST_CASE("sticking and sliding in turn at one instant has an end, of a body at the origin as of one elsewhere") {
  for (const Vector2d& origin : {Vector2d(0, 0), Vector2d(0.3, 0.2)}) {
    CAPTURE(origin.x());
    Scene s{.gravity = {0, -9.81}, .duration = 1e-9};
    const BodyId wedged = s.body({.mass = 1,
                                  .inertia = 0.0065633993750436066,
                                  .position = origin,
                                  .velocity = {0.61374940374007214, -0.51845052792440005},
                                  .omega = -2.6870708562974706});
    const auto corner = [&](const Vector2d& point, const Vector2d& normal, double mu, double e) {
      s.contact(CornerWall{{}, wedged, point, kGround, origin + point, normal, {.mu = mu, .e = e}});
    };
    corner({-0.19715753527719443, 0.018373004187347997}, {0.86548752701474529, 0.5009304747985498}, 0.94, 0.79);
    corner({0.16178979239196634, -0.034444053018734405}, {-0.89905473515968659, 0.43783625156780454}, 1.77, 0.15);
    const Run r = run(s, "event-driven:max_events=2000", 1e-9, {}, "auto");
    CHECK_MESSAGE(r.status == Status::solved, r.why);
    CHECK(r.events < 100);
  }
}

TEST_CASE("bodies crushed between others strike in turn within nanoseconds: adaptive keeps its tolerance") {
  // One where impacts follow within a picometre; one whose series another contact ends before its limit.
  for (const char* file : {"crushed_shapes.toml", "crushed_series.toml"}) {
    CAPTURE(file);
    const Scene scene = read_scene(std::string(ORTHANT_ROOT "/tests/data/") + file);
    const Run sharp = run(scene, "event-driven", 0.1);
    REQUIRE_MESSAGE(sharp.status == Status::solved, sharp.why);
    for (const char* rtol : {"1e-4", "1e-6", "1e-8"}) {
      CAPTURE(rtol);
      const Run rough = run(scene, std::string("adaptive:rtol=") + rtol, 0.1);
      REQUIRE_MESSAGE(rough.status == Status::solved, rough.why);
      CHECK(rough.crossings == 0);
      CHECK((rough.final.q - sharp.final.q).lpNorm<Eigen::Infinity>() < 100 * std::stod(rtol));
    }
  }
}
