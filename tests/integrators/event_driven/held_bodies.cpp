// Impulses and work of bodies that a belt or a drive holds while a force on them jumps.
#include "tests/support/runs.h"

#include <doctest/doctest.h>

using namespace orthant;

namespace {

constexpr double kStiffness = 500, kRest = 0.4, kSpeed = 1.1, kHook = 0.503;  // the spring's length is 0 at 0.457 s

/// [J] What the spring takes up until the time 1 s, at which the body is at kSpeed.
double stored() {
  const auto energy = [](double x) { return kStiffness / 2 * std::pow(std::abs(x - kHook) - kRest, 2); };
  return energy(kSpeed) - energy(0);
}

Scene driven() {
  Scene s{.gravity = {0, 0}};
  s.duration = 1;
  s.body({.mass = 1, .inertia = 0.01, .velocity = {kSpeed, 0}});
  s.joint(Prismatic{"rail", kGround, 0, {0, 0}, {0, 0}, {1, 0}, 0});
  s.joint(Drive{"motor", Slide{kGround, 0, {0, 0}, {0, 0}, {1, 0}}, TimeLaw{.rate_of_change = kSpeed}});
  s.spring(PointSpring{"spring", kGround, 0, {kHook, 0}, {0, 0}, kStiffness, 0, kRest});
  return s;
}

Scene on_belt() {
  Scene s{.gravity = {0, -1000}};
  s.duration = 1;
  s.body({.mass = 1, .inertia = 0.01, .position = {0, 0.1}, .velocity = {kSpeed, 0}});
  for (const double x : {-0.2, 0.2})
    s.contact(CornerWall{"", 0, {x, -0.1}, kGround, {0, 0}, {0, 1}, {.mu = 1, .belt = kSpeed}});
  s.spring(PointSpring{"spring", kGround, 0, {kHook, 0.1}, {0, 0}, kStiffness, 0, kRest});
  return s;
}

}  // namespace

TEST_CASE("a force that jumps on a body that is held shows in impulses and work") {
  for (const char* name : {"event-driven", "adaptive"}) {
    CAPTURE(name);
    const double allowed = name == std::string_view("adaptive") ? 1e-3 : 1e-6;  // of some 7 J
    for (const double h : {0.01, 0.3}) {
      CAPTURE(h);
      const Run drive = run(driven(), name, h), belt = run(on_belt(), name, h);
      CHECK(drive.status == Status::solved);
      CHECK(std::abs(drive.motion.work - stored()) <= allowed * stored());
      CHECK(belt.status == Status::solved);
      CHECK(std::abs(belt.motion.work - stored()) <= allowed * stored());
    }
  }
}
