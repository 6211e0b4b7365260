// Bodies that touch and that impulses of others move: schemes that hold gaps find all contacts, in every frame.
#include <doctest/doctest.h>

#include "tests/support/runs.h"

namespace orthant {
namespace {

/// A box whose corner touches a floor that it is about to leave, and one that slides onto it, all turned by `angle`.
/// Two other boxes meet nothing.
Scene struck_from_above(double angle) {
  const Eigen::Rotation2Dd turn(angle);
  Scene s{.gravity = turn * Vector2d(0, 4.754704896477344), .duration = 0.001729};
  const auto add = [&](const Vector2d& at, double inertia, const Vector2d& velocity) {
    return s.body({.mass = 1, .inertia = inertia, .position = turn * at, .angle = angle, .velocity = turn * velocity});
  };
  constexpr double kHalf = 0.11646483252081967;
  add({0, 0.1}, 0.01, {0, 0}), add({0.2, 0.1}, 0.01, {0, 0});
  const BodyId below = add({0.5, kHalf}, 0.01, {0, 0}), above = add({0.6, 0.3}, 0.005, {2, 0});
  s.contact(CornerWall{"floor", below, {0.125, -kHalf}, kGround, {0, 0}, turn * Vector2d(0, 1), {}});
  s.contact(PolygonPolygon{"top", below, rectangle(0.25, 2 * kHalf), above, rectangle(0.2, 0.15), 0, {.mu = 0.8}});
  return s;
}

}  // namespace

TEST_CASE("a box at rest on a floor that another one strikes: the frame does not matter") {
  for (const char* scheme : {"anitescu-potra", "stewart-trinkle"}) {
    CAPTURE(scheme);
    const Run a = run(struck_from_above(0), scheme, 0.002, {}, "auto");
    REQUIRE_MESSAGE(a.status == Status::solved, a.why);
    for (const double angle : {std::acos(0.0), 0.7, -2.0}) {
      CAPTURE(angle);
      const Run b = run(struck_from_above(angle), scheme, 0.002, {}, "auto");
      REQUIRE_MESSAGE(b.status == Status::solved, b.why);
      const Eigen::Rotation2Dd back(-angle);
      for (Eigen::Index body = 0; body < 4; ++body) {
        const Vector2d there = back * Vector2d(b.final.q.segment<2>(3 * body));
        CHECK((there - a.final.q.segment<2>(3 * body)).norm() < 1e-9);
        CHECK(std::abs(b.final.q[3 * body + 2] - angle - a.final.q[3 * body + 2]) < 1e-9);
      }
    }
  }
}

}  // namespace orthant
