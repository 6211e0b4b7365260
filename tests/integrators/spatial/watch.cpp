// What a run in space is watched for: overlap, energy balance, work, shapes that pass through each other.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

namespace {

constexpr std::string_view kInSpace[] = {"moreau-jean", "stewart-trinkle", "paoli-schatzman", "generalized-alpha"};
constexpr double kWeight = 9.81;

Run watched(const spatial::Scene& scene, std::string_view integrator, double step, double duration) {
  const SpatialSystem system(scene);
  const auto scheme = make_integrator(integrator, system);
  const auto solver = make_solver("auto");
  return simulate(*scheme, *solver, {.step = step, .duration = duration}, {});
}

spatial::Scene ball_at(double height, const ContactLaw& law) {
  spatial::Scene s;
  s.gravity = {0, 0, -kWeight};
  const auto ball =
      s.body({.name = "ball", .inertia = 0.01 * spatial::Matrix3d::Identity(), .position = {0, 0, height}});
  s.contact(spatial::SpherePlane{"floor", ball, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, {0, 0, 1}, law});
  return s;
}

}  // namespace

TEST_CASE("in space: a start deep in the floor that is shot off ends the run, one that is lifted is reported") {
  const spatial::Scene deep = ball_at(0.02, {.e = 0.5});
  CHECK(watched(deep, "paoli-schatzman", 1e-3, 0.2).status == Status::numerical_error);
  const Run lifted = watched(deep, "generalized-alpha", 1e-3, 0.2);
  CHECK(lifted.status == Status::solved);
  CHECK(lifted.motion.energy_defect == doctest::Approx(0.08 * kWeight).epsilon(0.01));
  CHECK(warnings_of(lifted.motion).size() == 1);
}

TEST_CASE("in space: an elastic ball keeps its energy, or the scheme that loses it says so") {
  for (const std::string_view scheme : kInSpace) {
    CAPTURE(scheme);
    const Run r = watched(ball_at(1.1, {.e = 1}), scheme, 1e-3, 20);
    CHECK(r.status == Status::solved);
    const double off = std::abs(r.energy_final - r.energy_initial);
    CHECK(r.motion.energy_scale == doctest::Approx(kWeight).epsilon(0.01));
    CHECK(r.motion.energy_defect >= 0.9 * off);
    CHECK(warnings_of(r.motion).size() == (off > 0.05 * kWeight ? 1 : 0));
  }
}

TEST_CASE("in space: work of loads and drives is what the energy changes by") {
  spatial::Scene s;
  const spatial::Matrix3d J = Vector3d(0.1, 0.2, 0.25).asDiagonal();
  const auto arm = s.body({.name = "arm", .inertia = J}),
             top = s.body({.name = "top", .inertia = J, .omega = {1, 9, 2}}),
             cart = s.body({.name = "cart", .position = {0, 5, 0}}),
             ring = s.body({.name = "ring", .inertia = J, .position = {9, 0, 0}, .omega = {0, 0, 6}}),
             rotor = s.body({.name = "rotor", .inertia = J, .position = {9, 0, 0}, .omega = {2, 0, 6}});
  s.joint(spatial::Spherical{"pin", kGround, arm, {0.1, 0, 0}, {0.1, 0, 0}});
  s.load({.name = "push",
          .body = arm,
          .point = {0, 0.3, 0},
          .force = {0, 0, 2},
          .moment = {0.1, 0, 0.3},
          .factor = [](double t) { return 1 + std::sin(7 * t); },
          .omega = 7});
  s.load({.name = "thrust", .body = top, .point = {0.1, 0, 0}, .force = {0, 0.5, 1}, .frame = spatial::Frame::body});
  s.joint(spatial::Prismatic{"rail", kGround, cart, {0, 5, 0}, {0, 0, 0}, {1, 0, 0}});
  s.joint(spatial::Drive{
      "shake", spatial::Slide{kGround, cart, {0, 5, 0}, {0, 0, 0}, {1, 0, 0}}, {.amplitude = 0.2, .omega = 5}});
  s.joint(spatial::Revolute{.name = "axle", .a = kGround, .b = ring, .point_a = {9, 0, 0}, .axis_a = {0, 0, 1}});
  s.joint(spatial::Revolute{.name = "hub", .a = ring, .b = rotor, .axis_a = {1, 0, 0}, .axis_b = {1, 0, 0}});
  s.joint(spatial::Drive{"spin", spatial::Angle{ring, rotor, {1, 0, 0}, {1, 0, 0}}, {.rate_of_change = 2}});
  for (const std::string_view scheme : kInSpace) {
    CAPTURE(scheme);
    const Run r = watched(s, scheme, 1e-3, 1);
    CHECK(r.status == Status::solved);
    CHECK(std::abs(r.motion.work) > 0.1);
    const double kept = r.energy_final - r.energy_initial - r.motion.work;
    const bool order_1 = scheme == "stewart-trinkle" || scheme == "paoli-schatzman";  // the joint takes energy
    CHECK(kept < 0.01 * r.motion.work);
    CHECK(kept > (order_1 ? -0.15 : -0.01) * r.motion.work);
    CHECK(r.motion.energy_defect < 0.01 * r.motion.energy_scale);
  }
}

TEST_CASE("in space: a step too long for a socket is reported with its clearance; far out of it the run ends") {
  spatial::Scene s;
  s.body({.name = "ball", .velocity = {0, 0, 1}});
  s.contact(spatial::Socket{"socket", 0, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, 0.1001, {}});
  const Run slow = watched(s, "moreau-jean", 3e-4, 0.01);
  CHECK(slow.status == Status::solved);
  CHECK(slow.motion.smallest_clearance == doctest::Approx(1e-4));
  REQUIRE(warnings_of(slow.motion).size() == 1);
  CHECK(warnings_of(slow.motion)[0].find("at contact \"socket\", where the clearance is 0.0001 m") !=
        std::string::npos);
}

TEST_CASE("in space: shapes that pass through each other within a step are reported; those that pass by are not") {
  const auto shot = [](double aside, int kind) {
    spatial::Scene s;
    s.duration = 0.1;
    const spatial::Matrix3d J = 0.01 * spatial::Matrix3d::Identity();
    const auto ball = s.body({.name = "ball", .inertia = J, .position = {-5, 0, 0}, .velocity = {100, 0, 0}}),
               target = s.body({.name = "target", .inertia = J, .position = {0, aside, 0}});
    spatial::Shape plate{target, spatial::box_corners({0.05, 0.5, 0.5}), 0};
    if (kind == 1) plate = {target, {{0, -0.4, 0}, {0, 0.4, 0}}, 0.1};
    if (kind == 2)
      s.contact(spatial::SphereSphere{"touch", ball, {0, 0, 0}, 0.1, target, {0, 0, 0}, 0.15, {}});
    else
      s.collision({.name = "all", .shapes = {{ball, {{0, 0, 0}}, 0.1}, plate}, .law = {}});
    return s;
  };
  for (const std::string_view scheme : kInSpace)
    for (const int kind : {0, 1, 2}) {
      CAPTURE(scheme);
      CAPTURE(kind);
      const Run through = watched(shot(0.1, kind), scheme, 0.03, 0.1);
      CHECK(through.status == Status::solved);
      CHECK(through.passages == 1);
      CHECK(through.first_passage.moved == doctest::Approx(3).epsilon(1e-9));
      CHECK(watched(shot(0.7, kind), scheme, 0.03, 0.1).passages == 0);
      CHECK(watched(shot(-0.7, kind), scheme, 0.03, 0.1).passages == 0);
      const Run hit = watched(shot(0.1, kind), scheme, 1e-4, 0.1);
      CHECK(hit.passages == 0);
      CHECK(hit.final.v[0] < 90);
    }
}

TEST_CASE("adaptive in space: a sign that is rounding hides no later contact of the same inner step") {
  const auto scene = std::get<spatial::Scene>(read_any_scene(ORTHANT_TEST_DATA "/bush_two_rims.toml"));
  const SpatialSystem system(scene);
  for (const std::string_view scheme : {"adaptive", "event-driven"}) {
    CAPTURE(scheme);
    const Run run = run_in_space(system, scheme, scheme == "adaptive" ? scene.step : 0.2, scene.duration);
    CHECK(run.max_penetration < 1e-9);
  }
}
