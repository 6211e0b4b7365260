// Equivalent scenes: every integrator gives the same motion, as exactly as its arithmetic can. The scene is the
// slider-crank in its first 20 ms: flight, an accumulation of impacts, sliding contact of two corners.
#include "experiments/studies/motion_storm/twin.h"
#include "experiments/studies/support/equivalent_scene.h"
#include "tests/support/runs.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace orthant;

namespace {

const SliderCrank kDrawing{.mu = 0.1};

/// Seen by an observer who moves with the opposite velocity.
Scene boosted(Scene s, const Vector2d& velocity) {
  for (Body& b : s.bodies) b.velocity += velocity;
  return s;
}

/// Two rods on a pin that fall together with a plate, strike it and slide along it; nothing is fixed to the ground.
Scene free_flyers() {
  Scene s{.gravity = {0, -9.81}};
  const BodyId plate = s.body({.mass = 3, .inertia = 0.5, .omega = 0.1});
  const BodyId left = s.body({.mass = 1, .inertia = 0.1, .position = {-0.5, 0.101}, .velocity = {1, -0.4}});
  const BodyId right = s.body({.mass = 1, .inertia = 0.1, .position = {0.5, 0.101}, .velocity = {1, -0.6}});
  s.joint(Revolute{"pin", left, right, {0.5, 0}, {-0.5, 0}});
  const ContactLaw law{.mu = 0.2, .e = 0.3};
  s.contact(CornerWall{"a", left, {-0.5, -0.1}, plate, {0, 0}, {0, 1}, law});
  s.contact(CornerWall{"b", right, {0.5, -0.1}, plate, {0, 0}, {0, 1}, law});
  return s;
}

/// 14 km away: a disc that rests on a floor, one that bounces, a pendulum.
Scene with_distant_company(Scene s) {
  constexpr double kFar = 1e4;
  const ContactLaw law{.mu = 0.3, .e = 0.5};
  const auto disc = [&](const char* name, double x, double height) {
    const BodyId body = s.body({.name = name, .inertia = 1, .position = {x, kFar + height}});
    s.contact(DiscWall{name + std::string("-floor"), body, {0, 0}, 0.5, kGround, {x, kFar - 0.5}, {0, 1}, law});
  };
  disc("rests", kFar, 0), disc("bounces", kFar + 2, 1e-4);
  const BodyId bob = s.body({.name = "bob", .mass = 2, .inertia = 1, .position = {kFar + 4, kFar}});
  s.joint(Revolute{"pivot", kGround, bob, {kFar + 3, kFar}, {-1, 0}});
  return s;
}

/// A box that falls tilted on a floor with friction, a pendulum that swings against an angular stop, a ball on a slack
/// rope, a pin that rattles in a bush.
std::vector<Scene> scenes_of_half_a_second() {
  std::vector<Scene> all;
  {
    Scene s{.gravity = {0, -9.81}, .duration = 0.5};
    const Polygon box{{-0.2, -0.2}, {0.2, -0.2}, {0.2, 0.2}, {-0.2, 0.2}}, floor{{-5, -1}, {5, -1}, {5, 0}, {-5, 0}};
    s.body({.inertia = 0.027, .position = {0, 0.5}, .angle = 0.3, .velocity = {1, 0}});
    for (const int point : {0, 1})
      s.contact(PolygonPolygon{"box" + std::to_string(point), 0, box, kGround, floor, point, {.mu = 0.3, .e = 0.4}});
    all.push_back(s);
  }
  {
    Scene s{.gravity = {0, -9.81}, .duration = 0.5};
    const BodyId rod = s.body({.inertia = 0.1, .position = {0.5, 0}});
    s.joint(Revolute{"pivot", kGround, rod, {0, 0}, {-0.5, 0}});
    s.contact(Limit{"stop", Angle{kGround, rod}, Limit::Side::lower, -0.5, {.e = 0.5}});
    all.push_back(s);
  }
  {
    Scene s{.gravity = {0, -9.81}, .duration = 0.5};
    const BodyId ball = s.body({.inertia = 0.01, .position = {0.3, 0}, .omega = 1});
    s.contact(Limit{"rope", Span{kGround, ball, {0, 0}, {0, 0.1}}, Limit::Side::upper, 0.6, {.e = 0.3}});
    all.push_back(s);
  }
  {
    Scene s{.gravity = {0, -9.81}, .duration = 0.5};
    const BodyId rod = s.body({.inertia = 0.05, .position = {0.5, 0}, .omega = 1});
    s.contact(Journal{"bush", rod, {-0.5, 0}, 0.1, kGround, {0, 0}, 0.11, {.mu = 0.1, .e = 0.2}});
    all.push_back(s);
  }
  return all;
}

Run run_20ms(Scene s, std::string_view integrator) {
  s.duration = 0.02;
  const Run r = run(s, integrator, 1e-4);
  REQUIRE(r.status == Status::solved);
  return r;
}

/// [rad], [m]: the same arithmetic but for rounding. `adaptive` chooses its step anew where the numbers differ (its
/// norm knows the scene's size), so that it is asked for much and agrees within what it reaches.
double agreement(std::string_view name) { return name == "adaptive" ? 1e-7 : 1e-10; }

template <class Claim> void for_each_integrator(Claim&& claim) {
  for (const IntegratorEntry& entry : integrators()) {
    CAPTURE(entry.name);
    claim(entry.name == "adaptive" ? "adaptive:rtol=1e-12,atol=1e-15" : std::string(entry.name), agreement(entry.name));
  }
}

}  // namespace

TEST_CASE("metamorphic: order of bodies, joints and contacts") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank(kDrawing), name), b = run_20ms(reversed(slider_crank(kDrawing)), name);
    CHECK(std::abs(a.final.q[kTheta1] - b.final.q[8]) <= same);
  });
}

TEST_CASE("metamorphic: mirror image") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank(kDrawing), name), b = run_20ms(mirrored(slider_crank(kDrawing)), name);
    CHECK(std::abs(a.final.q[kTheta1] + b.final.q[kTheta1]) <= same);
  });
}

TEST_CASE("metamorphic: units of length and mass") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank(kDrawing), name);
    const Run b = run_20ms(in_units(slider_crank(kDrawing), 1024, 0.25), name);
    CHECK(std::abs(a.final.q[kTheta1] - b.final.q[kTheta1]) <= same);
  });
}

TEST_CASE("metamorphic: from nanometres to kilometres") {
  std::vector<Scene> scenes = scenes_of_half_a_second();
  scenes.push_back(slider_crank(kDrawing));
  scenes.back().duration = 0.02;
  for_each_integrator([&](const std::string& name, double) {
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      const double step = scenes[k].duration / 200;
      const Run a = run(scenes[k], name, step);
      for (const double scale : {1e-9, 1e-6, 1e-3, 1e3}) {
        const Run b = run(motion_storm::twin_of(scenes[k], {.lambda = scale}), name, step);
        INFO("scene ", k, ", scale ", scale, ": ", b.why);
        CHECK(b.status == a.status);
        double off = 0;
        for (Eigen::Index i = 0; i < a.final.q.size(); ++i)
          off = std::max(off, std::abs(a.final.q[i] - b.final.q[i] / (i % 3 == 2 ? 1 : scale)));
        const bool angle_far = k == 1 && scale > 1 && name == "rattle";  // an angle counts as places round there
        CHECK(off < (angle_far ? 1e-5 : 1e-9));
      }
    }
  });
}

TEST_CASE("metamorphic: turned with gravity, and moved elsewhere") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank(kDrawing), name);
    const Run turned = run_20ms(moved(slider_crank(kDrawing), 0.7, {0, 0}), name);
    CHECK(std::abs(a.final.q[kTheta1] - (turned.final.q[kTheta1] - 0.7)) <= same);
    const Run near = run_20ms(moved(slider_crank(kDrawing), 0, {3, -2}), name);
    CHECK(std::abs(a.final.q[kTheta1] - near.final.q[kTheta1]) <= same);
    const Run far = run_20ms(moved(slider_crank(kDrawing), 0, {1e6, 1e6}), name);
    const double loss = std::abs(a.final.q[kTheta1] - far.final.q[kTheta1]);
    MESSAGE(name << ": " << loss << " rad are lost 1000 km away");
    CHECK(loss <= 1e-2);
  });
}

TEST_CASE("metamorphic: far bodies and walls that nothing reaches change nothing, cost nothing") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank(kDrawing), name), b = run_20ms(furnished(slider_crank(kDrawing)), name);
    CHECK(std::abs(a.final.q[kTheta1] - b.final.q[kTheta1]) <= same);
    CHECK(b.lcp_solves <= 1.05 * static_cast<double>(a.lcp_solves) + 5);
    CHECK(static_cast<double>(b.accepted + b.rejected) <= 1.05 * static_cast<double>(a.accepted + a.rejected) + 5);
  });
}

TEST_CASE("metamorphic: bodies that rest, bounce and swing 14 km away change nothing") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank(kDrawing), name),
              b = run_20ms(with_distant_company(slider_crank(kDrawing)), name);
    CHECK((a.final.q - b.final.q.head(9)).lpNorm<Eigen::Infinity>() <= same);
  });
}

TEST_CASE("metamorphic: a body that flies past at 1e9 m/s changes nothing, with driven and with corrected joints") {
  const auto ends = [](double speed, const std::string& name) {
    Scene s{.gravity = {0, -9.81}, .duration = 0.5};
    const auto crank = s.body({.name = "crank", .position = {0.5, 0}, .velocity = {0, 1}, .omega = 2});
    const auto rod = s.body({.name = "rod", .position = {1.5, 0}, .velocity = {0, 1}});
    s.body({.name = "other", .position = {0, 5}, .velocity = {speed, 0}});
    s.joint(Revolute{"pivot", kGround, crank, {0, 0}, {-0.5, 0}});
    s.joint(Revolute{"pin", crank, rod, {0.5, 0}, {-0.5, 0}});
    s.joint(Drive{"motor", Angle{kGround, crank}, {.rate_of_change = 2}});
    return run(s, name, 1e-2).final;
  };
  for (const std::string name : {"moreau-jean", "stewart-trinkle", "rattle"}) {
    CAPTURE(name);
    CHECK((ends(0, name).q - ends(1e9, name).q).head(6).lpNorm<Eigen::Infinity>() < 1e-12);
  }
}

// They cost 3 to 13 % alone on a machine; the bound leaves room for what else runs. Rows for them would cost 90 %.
TEST_CASE("metamorphic: the time that they cost" * doctest::test_suite("slow")) {
  const auto seconds = [](const Scene& s) { return run(s, "moreau-jean", 1e-5).seconds; };
  Scene plain = slider_crank(kDrawing), more = furnished(slider_crank(kDrawing));
  plain.duration = more.duration = 0.02;
  double least = seconds(plain), least_more = seconds(more);
  for (int k = 0; k < 500 && !(least_more <= 1.05 * least); ++k)  // least of many: other work only adds
    least = std::min(least, seconds(plain)), least_more = std::min(least_more, seconds(more));
  MESSAGE("a far body and four walls: " << least_more / least << " of the time");
  CHECK(least_more <= 1.3 * least);
}

TEST_CASE("metamorphic: a frictionless contact written as a frictional one") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank({.mu = 0}), name), b = run_20ms(slider_crank({.mu = 1e-14}), name);
    CHECK(std::abs(a.final.q[kTheta1] - b.final.q[kTheta1]) <= same);
  });
}

TEST_CASE("metamorphic: other names, and a joint and a contact written twice") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank(kDrawing), name);
    CHECK(run_20ms(renamed(slider_crank(kDrawing)), name).final.q == a.final.q);
    CHECK(std::abs(run_20ms(doubled(slider_crank(kDrawing)), name).final.q[kTheta1] - a.final.q[kTheta1]) <= same);
  });
}

TEST_CASE("metamorphic: Galilean boost") {
  for_each_integrator([](const std::string& name, double same) {
    const Vector2d boost{3, -2};
    const Run a = run_20ms(free_flyers(), name), b = run_20ms(boosted(free_flyers(), boost), name);
    for (Index i = 0; i < 3; ++i) {
      CHECK((a.final.q.segment<2>(3 * i) + 0.02 * boost - b.final.q.segment<2>(3 * i)).norm() <= same);
      CHECK(std::abs(a.final.q[3 * i + 2] - b.final.q[3 * i + 2]) <= same);
    }
    CHECK(a.final.v[0] > 0.01);  // they met, the plate is taken along
  });
}
