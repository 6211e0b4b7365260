// Starts with overlap: a body that rises within it stops where it would sink again, at any output step.
#include "tests/support/runs.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

namespace {

constexpr double kDisc = 0.2, kFall = 9.81;  // [m], [m/s²]

/// A disc 3 cm deep in the floor that rises at `speed` [m/s].
Scene sunk(double speed, double duration) {
  Scene s{.gravity = {0, -kFall}};
  s.body({.mass = 1, .inertia = 0.02, .position = {0, kDisc - 0.03}, .velocity = {0.1, speed}});
  s.contact(DiscWall{{}, 0, {0, 0}, kDisc, kGround, {0, 0}, {0, 1}, {.e = 0.5}});
  s.duration = duration;
  return s;
}

}  // namespace

TEST_CASE("overlap: a disc that does not come out of the floor rests, one that does falls back onto the floor") {
  for (const char* scheme : {"event-driven", "adaptive"})
    for (const double step : {0.0007, 0.011, 0.1}) {
      INFO(scheme, " ", step);
      const Run low = run(sunk(0.6, 0.11), scheme, step);  // turns at t = 0.0612, 1.2 cm deep
      CHECK(low.status == Status::solved);
      CHECK(low.final.q[1] == doctest::Approx(kDisc).epsilon(1e-9));
      CHECK(std::abs(low.final.v[1]) < 1e-9);
      const double v = std::sqrt(1.2 * 1.2 - 2 * kFall * 0.03), back = (1.2 + v) / kFall, left = 0.3 - back;
      const Run high = run(sunk(1.2, 0.3), scheme, step);
      CHECK(high.status == Status::solved);
      CHECK(high.final.q[1] == doctest::Approx(kDisc + v / 2 * left - kFall / 2 * left * left).epsilon(1e-7));
      CHECK(high.final.v[1] == doctest::Approx(v / 2 - kFall * left).epsilon(1e-6));
    }
}

TEST_CASE("overlap: a block with one corner 5 mm deep moves on in the same way at any output step") {
  constexpr double kAngle = 2.8, kFloor = 0.05, kHeight = 0.26;
  const Vector2d corner(-0.135, 0.1798);
  CHECK(kHeight + std::sin(kAngle) * corner.x() + std::cos(kAngle) * corner.y() < kFloor - 0.004);
  Scene s{.gravity = {0, -kFall}};
  s.body({.inertia = 0.017, .position = {0, kHeight}, .angle = kAngle});
  s.contact(CornerWall{{}, 0, corner, kGround, {0, kFloor}, {0, 1}, {}});
  s.duration = 0.1;
  const auto end = [&](int steps) { return run(s, "event-driven", s.duration / steps).final.q; };
  const auto once = end(1);
  for (const int steps : {4, 20, 140}) CHECK((end(steps) - once).lpNorm<Eigen::Infinity>() < 1e-12);
}
