// Ends of ropes that run into their pulleys, and distances of joints that become 0.
#include "tests/support/runs.h"
#include "tests/support/told_time.h"

#include <orthant/core/mechanics/planar/relation.h>
#include <orthant/core/scenes/motion.h>

#include <doctest/doctest.h>

using namespace orthant;

TEST_CASE("an end that swings about its pulley has not run into it, whatever the output step") {
  Scene s{.gravity = {0, 0}};
  const BodyId ball = s.body({.name = "ball", .mass = 1, .inertia = 0.01, .position = {1, 0}, .velocity = {0, 5}});
  const BodyId weight = s.body({.name = "weight", .mass = 1e6, .inertia = 1e4, .position = {5, -1}});
  s.contact(RelationLimit("rope",
                          {{1, Span{kGround, ball, {0, 0}, {0, 0}}}, {1, Span{kGround, weight, {5, 0}, {0, 0}}}},
                          Limit::Side::upper, 2));
  for (const char* scheme : {"event-driven", "adaptive"})
    for (const double step : {0.1, 0.5, 2.0}) {
      CAPTURE(scheme);
      CAPTURE(step);
      const Run run = run_for(s, 2, scheme, step);
      CHECK(run.status == Status::solved);
      CHECK((run.final.q.head(2) - Eigen::Vector2d(std::cos(10), std::sin(10))).norm() < 1e-3);
    }
}

TEST_CASE("an end of a rope that runs into its pulley ends the run, in words and at its time") {
  Scene s{.gravity = {0, -kGravity}};
  const BodyId light = s.body({.name = "light", .inertia = 0.01, .position = {-0.2, -1}}),
               heavy = s.body({.name = "heavy", .mass = 2, .inertia = 0.01, .position = {0.2, -1}});
  const double due = std::sqrt(2 * 3 / kGravity);  // at g / 3 over 1 m
  s.contact(RelationLimit("rope",
                          {{1, Span{kGround, light, {-0.2, 0}, {0, 0}}}, {1, Span{kGround, heavy, {0.2, 0}, {0, 0}}}},
                          Limit::Side::upper, 2));
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    const Run r = run_for(s, 2, scheme.name, 1e-3);
    CAPTURE(r.why);
    CHECK(r.status == Status::numerical_error);
    CHECK(r.why.starts_with("an end of rope \"rope\" has run into its pulley"));
    CHECK(std::abs(told_time(r.why) - due) < 5e-3);
  }
}

TEST_CASE("a distance that a joint holds becomes 0: the run ends there, in words, with every integrator") {
  Scene rope{.gravity = {0, 0}};
  const BodyId one = rope.body({.name = "one", .position = {0.6, 0}, .velocity = {-0.5, 0}}),
               other = rope.body({.name = "other", .position = {0.5, 1}, .velocity = {0.5, 0}});
  rope.joint(
      Relation("rope", {{1, Span{kGround, one, {0, 0}, {0, 0}}}, {1, Span{kGround, other, {0, 1}, {0, 0}}}}, 1.1));
  Scene arm{.gravity = {0, 0}};
  const BodyId slider = arm.body({.name = "slider", .position = {0.6, 0}});
  arm.joint(Drive{"winch", Span{kGround, slider, {0, 0}, {0, 0}}, {.offset = 0.6, .rate_of_change = -0.5}});
  for (const IntegratorEntry& scheme : integrators()) {
    CAPTURE(scheme.name);
    const Run held = run_for(rope, 2, scheme.name, 1e-3), driven = run_for(arm, 2, scheme.name, 1e-3);
    CAPTURE(held.why);
    CAPTURE(driven.why);
    CHECK(held.status == Status::numerical_error);
    CHECK(held.why.starts_with("a distance of joint \"rope\" has become 0, where it has no direction"));
    CHECK(std::abs(told_time(held.why) - 1.2) < 5e-3);
    CHECK(driven.status == Status::infeasible);
    CHECK(driven.why.starts_with("jammed: drive \"winch\", the joints leave no motion"));
    CHECK(std::abs(told_time(driven.why) - 1.2) < 5e-3);
  }
}

TEST_CASE("no step passes over the pulley of a joint's rope unseen") {
  Scene s{.gravity = {0, 0}};
  const BodyId one = s.body({.name = "one", .position = {0.6, 0}, .velocity = {-0.5, 0}}),
               other = s.body({.name = "other", .position = {0.5, 1}, .velocity = {0.5, 0}});
  s.joint(Relation("rope", {{1, Span{kGround, one, {0, 0}, {0, 0}}}, {1, Span{kGround, other, {0, 1}, {0, 0}}}}, 1.1));
  for (const char* scheme : {"event-driven", "adaptive"})
    for (const double step : {0.01, 1.0}) {
      CAPTURE(scheme);
      CAPTURE(step);
      const Run run = run_for(s, 1, scheme, step);
      CHECK(run.status == Status::solved);
      CHECK(run.final.q[0] == doctest::Approx(0.1).epsilon(1e-9));
      CHECK(run.final.v[0] == doctest::Approx(-0.5).epsilon(1e-9));
    }
}
