// The same motion told otherwise: every integrator has to give the same answer, as exactly as its arithmetic can.
// Told on the slider-crank's first 20 ms: flight, an accumulation of impacts, sliding contact of two corners.
#include "tests/support/runs.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace orthant;

namespace {

const SliderCrank kDrawing{.mu = 0.1};

/// Turns by `angle`, then shifts; what is fixed to the ground goes along, what is fixed to bodies stays with them.
Scene moved(Scene s, double angle, const Vector2d& shift) {
  const Pose pose{shift, angle, std::cos(angle), std::sin(angle)};
  const auto point = [&](BodyId body, Vector2d& p) {
    if (body == kGround) p = pose.turn(p) + shift;
  };
  s.gravity = pose.turn(s.gravity);
  for (Body& b : s.bodies)
    b.position = pose.turn(b.position) + shift, b.velocity = pose.turn(b.velocity), b.angle += angle;
  for (Joint& j : s.joints) {
    auto& pin = std::get<Revolute>(j);
    point(pin.a, pin.point_a), point(pin.b, pin.point_b);
  }
  for (Contact& c : s.contacts) {
    auto& wall = std::get<CornerWall>(c);
    point(wall.b, wall.wall_point);
    wall.normal = pose.turn(wall.normal).normalized();
  }
  return s;
}

Scene mirrored(Scene s) {
  const auto flip = [](auto&... v) { ((v.x() = -v.x()), ...); };
  flip(s.gravity);
  for (Body& b : s.bodies) flip(b.position, b.velocity), b.angle = -b.angle, b.omega = -b.omega;
  for (Joint& j : s.joints) flip(std::get<Revolute>(j).point_a, std::get<Revolute>(j).point_b);
  for (Contact& c : s.contacts) {
    auto& wall = std::get<CornerWall>(c);
    flip(wall.point, wall.wall_point, wall.normal);
  }
  return s;
}

/// Other units of length and mass, both by powers of two.
Scene in_units(Scene s, double length, double mass) {
  s.gravity *= length;
  for (Body& b : s.bodies)
    b.position *= length, b.velocity *= length, b.mass *= mass, b.inertia *= mass * length * length;
  for (Joint& j : s.joints) std::get<Revolute>(j).point_a *= length, std::get<Revolute>(j).point_b *= length;
  for (Contact& c : s.contacts) std::get<CornerWall>(c).point *= length, std::get<CornerWall>(c).wall_point *= length;
  return s;
}

/// Bodies, joints and contacts in the opposite order.
Scene reversed(Scene s) {
  const auto n = static_cast<BodyId>(s.bodies.size());
  const auto renumber = [&](BodyId& body) { body = body == kGround ? kGround : n - 1 - body; };
  for (Joint& j : s.joints) renumber(std::get<Revolute>(j).a), renumber(std::get<Revolute>(j).b);
  for (Contact& c : s.contacts) renumber(std::get<CornerWall>(c).a), renumber(std::get<CornerWall>(c).b);
  std::reverse(s.bodies.begin(), s.bodies.end());
  std::reverse(s.joints.begin(), s.joints.end());
  std::reverse(s.contacts.begin(), s.contacts.end());
  return s;
}

/// A far body that never meets anything, and walls too far away to be reached.
Scene furnished(Scene s) {
  s.body({.name = "far", .inertia = 1, .position = {50, 0}, .velocity = {0, 1}});
  for (int i = 0; i < 4; ++i)
    s.contact(CornerWall{"", 2, {0, 0}, kGround, {0, -10.0 - i}, {0, 1}, {.mu = 0.3, .e = 0.5}});
  return s;
}

Run run_20ms(Scene s, std::string_view integrator) {
  s.duration = 0.02;
  const Run r = run(s, integrator, 1e-4);
  REQUIRE(r.status == Status::solved);
  return r;
}

/// Schemes of fixed step do the same arithmetic but for rounding; those that choose their step choose it anew where the
/// numbers differ, and agree within their tolerance.
double agreement(std::string_view name) {
  return name == "adaptive" || name == "event-driven" ? 1e-5 : 1e-9;  // [rad]
}

template <class Claim> void for_each_integrator(Claim&& claim) {
  for (const IntegratorEntry& entry : integrators()) {
    CAPTURE(entry.name);
    claim(std::string(entry.name), agreement(entry.name));
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

TEST_CASE("metamorphic: a frictionless contact written as a frictional one") {
  for_each_integrator([](const std::string& name, double same) {
    const Run a = run_20ms(slider_crank({.mu = 0}), name), b = run_20ms(slider_crank({.mu = 1e-14}), name);
    CHECK(std::abs(a.final.q[kTheta1] - b.final.q[kTheta1]) <= same);
  });
}
