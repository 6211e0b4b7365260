// Jams of drives in space: found by a search of positions, and named by every integrator of fixed steps.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/integrators/step/jam.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace orthant;

namespace {

const Eigen::Quaterniond kTilt(Eigen::AngleAxisd(0.8, Vector3d(1, 2, -1).normalized()));
const Vector3d kAlong = kTilt * Vector3d::UnitX(), kAcross = kTilt * Vector3d::UnitZ();

spatial::Matrix3d askew_inertia() {
  return (spatial::Matrix3d() << 0.1, 0.02, 0, 0.02, 0.12, 0.01, 0, 0.01, 0.1).finished();
}

/// A jaw on a driven rail closes on a ball of 0.1 m; masses far apart.
spatial::Scene vise_in_space(double ball_mass) {
  spatial::Scene s;
  const BodyId jaw = s.body({.name = "jaw", .inertia = askew_inertia(), .position = kAlong, .velocity = -kAlong}),
               ball = s.body({.name = "ball",
                              .mass = ball_mass,
                              .inertia = 0.004 * ball_mass * spatial::Matrix3d::Identity(),
                              .position = 0.3 * kAlong});
  s.joint(spatial::Prismatic{"rail", kGround, jaw, {0, 0, 0}, {0, 0, 0}, kAlong});
  s.joint(spatial::Drive{
      "ram", spatial::Slide{kGround, jaw, {0, 0, 0}, {0, 0, 0}, kAlong}, {.offset = 1, .rate_of_change = -1}});
  s.contact(spatial::SpherePlane{"wall", ball, {0, 0, 0}, 0.1, kGround, {0, 0, 0}, kAlong, {.mu = 0.2, .e = 0.3}});
  s.contact(spatial::SpherePlane{"face", ball, {0, 0, 0}, 0.1, jaw, {0, 0, 0}, -kAlong, {.mu = 0.2, .e = 0.3}});
  return s;
}

/// A crank of radius 0.3 turns about the line y = 0, z = 0.1 along x; a rod of length 1 pulls a slider
/// along x: s² = 1 − 0.3² − 0.1² − 0.06 sin φ, φ of the crank's pin from its place at the start.
spatial::Scene driven_slider(double stop) {
  const Vector3d pin(0, 0.3, 0.1), slide(std::sqrt(1 - 0.1), 0, 0);
  spatial::Scene s;
  const BodyId crank = s.body({.name = "crank", .mass = 3, .inertia = askew_inertia(), .position = {0, 0, 0.1}}),
               slider = s.body({.name = "slider", .mass = 0.02, .inertia = 1e-5 * askew_inertia(), .position = slide});
  const spatial::Revolute shaft{"shaft",   kGround,   crank,     {0, 0, 0.1}, {0, 0, 0},
                                {1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}};
  s.joint(shaft);
  s.joint(spatial::Drive{"motor", shaft.angle(), {.rate_of_change = -5}});
  s.joint(spatial::Prismatic{"rail", kGround, slider, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  s.joint(spatial::Distance{"rod", crank, slider, pin - Vector3d(0, 0, 0.1), {0, 0, 0}, 1});
  s.contact(spatial::Limit{
      "stop", spatial::Slide{kGround, slider, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, spatial::Limit::Side::upper, stop, {}});
  return s;
}

}  // namespace

TEST_CASE("in space: a vise that closes on a ball is jammed, in the words and at the time of the plane's") {
  for (const std::string_view scheme :
       {"moreau-jean", "stewart-trinkle", "anitescu-potra", "paoli-schatzman", "generalized-alpha", "rattle"})
    for (const double mass : {1.0, 50.0}) {
      CAPTURE(scheme);
      CAPTURE(mass);
      const SpatialSystem system(vise_in_space(mass));
      const auto integrator = make_integrator(scheme, system);
      const Run r = simulate(*integrator, *make_solver("auto"), {.step = 1e-3, .duration = 1}, {});
      CHECK(r.status == Status::infeasible);
      CHECK(r.why == "jammed: drive \"ram\", contacts \"wall\" and \"face\" leave no motion; since t = 0.8");
      CHECK(std::abs(r.final.t - 0.8) < 3e-3);
    }
}

TEST_CASE("in space: a position search ends where a closed form says that the slider strikes its stop") {
  for (const double stop : {0.97, 0.975}) {
    CAPTURE(stop);
    const double due = std::asin((stop * stop - 0.9) / 0.06) / 5;
    const SpatialSystem system(driven_slider(stop));
    JamSearchOf<Spatial> search(system);
    const auto jam = search.find(system.initial_state(), 30);
    REQUIRE(jam.has_value());
    CHECK(jam->since == doctest::Approx(due).epsilon(1e-6));
    CHECK(words(*jam).starts_with("jammed: drive \"motor\", contact \"stop\" leave no motion; since t = "));
    CHECK(!search.find(system.initial_state(), 0.999 * due).has_value());
    CHECK(search.looked_until() == doctest::Approx(0.999 * due));
  }
  const SpatialSystem free(driven_slider(0.98));  // √0.96 is less
  JamSearchOf<Spatial> search(free);
  CHECK(!search.find(free.initial_state(), 30).has_value());
  CHECK(search.looked_until() == 30);
}

TEST_CASE("a position search steps over no bolt that is narrow against a turn, in the plane and in space") {
  const double due = (std::numbers::pi - std::asin(0.8) - 2 * std::asin(0.02)) / 20;
  const auto in_space = [](double beside) {
    spatial::Scene s;
    const BodyId arm = s.body({.name = "arm", .inertia = askew_inertia(), .position = 0.5 * kAlong});
    const spatial::Revolute pin{"pin", kGround, arm, {0, 0, 0}, -0.5 * kAlong, kAcross, kAcross, kAlong, kAlong};
    s.joint(pin);
    s.joint(spatial::Drive{"motor", pin.angle(), {.rate_of_change = 20}});
    s.contact(
        spatial::SphereSphere{"bolt", arm, 0.5 * kAlong, 0.02, kGround, kTilt * Vector3d(-0.6, 0.8, beside), 0.02, {}});
    return s;
  };
  Scene flat;
  const BodyId arm = flat.body({.name = "arm", .inertia = 0.1, .position = {0.5, 0}});
  flat.joint(Revolute{"pin", kGround, arm, {0, 0}, {-0.5, 0}});
  flat.joint(Drive{"motor", Angle{kGround, arm}, {.rate_of_change = 20}});
  flat.contact(DiscDisc{"bolt", arm, {0.5, 0}, 0.02, kGround, {-0.6, 0.8}, 0.02, {}});
  const auto found = [&](const auto& system, auto search) {
    const auto jam = search.find(system.initial_state(), 5);
    REQUIRE(jam.has_value());
    CHECK(jam->since == doctest::Approx(due).epsilon(1e-7));
    CHECK(words(*jam) == "jammed: drive \"motor\", contact \"bolt\" leave no motion; since t = 0.108715");
  };
  const System planar(flat);
  const SpatialSystem spatial(in_space(0)), beside(in_space(0.05));
  found(planar, JamSearch(planar));
  found(spatial, JamSearchOf<Spatial>(spatial));
  JamSearchOf<Spatial> search(beside);
  CHECK(!search.find(beside.initial_state(), 5).has_value());
  CHECK(search.looked_until() == 5);
}

TEST_CASE("in space: drives that contradict each other, and boxes of a collision, whose pair is named once") {
  spatial::Scene fight;
  const BodyId rotor = fight.body({.name = "rotor", .inertia = askew_inertia()});
  const spatial::Revolute shaft{"shaft", kGround, rotor, {0, 0, 0}, {0, 0, 0}, kAlong, kAlong, kAcross, kAcross};
  fight.joint(shaft);
  fight.joint(spatial::Drive{"one", shaft.angle(), {.rate_of_change = 1}});
  fight.joint(spatial::Drive{"other", shaft.angle(), {.rate_of_change = 2}});
  const SpatialSystem two(fight);
  const auto jam = JamSearchOf<Spatial>(two).find(two.initial_state(), 1);
  REQUIRE(jam.has_value());
  CHECK(words(*jam) == "jammed: drives \"one\" and \"other\", the joints leave no motion; since t = 0");

  spatial::Scene press;
  const BodyId jaw = press.body({.name = "jaw", .position = {1, 0, 0}}),
               box = press.body({.name = "box", .inertia = 0.01 * askew_inertia(), .position = {0.3, 0, 0}});
  press.joint(spatial::Prismatic{"rail", kGround, jaw, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  press.joint(spatial::Drive{
      "ram", spatial::Slide{kGround, jaw, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, {.offset = 1, .rate_of_change = -1}});
  press.collision({.name = "heap",
                   .shapes = {{jaw, spatial::box_corners({0.05, 0.5, 0.5}), 0},
                              {box, spatial::box_corners({0.1, 0.1, 0.1}), 0},
                              {kGround, spatial::box_corners({0.05, 0.5, 0.5}), 0}},
                   .law = {}});
  const SpatialSystem pressed(press);
  const auto boxes = JamSearchOf<Spatial>(pressed).find(pressed.initial_state(), 2);
  REQUIRE(boxes.has_value());
  CHECK(boxes->since == doctest::Approx(0.7).epsilon(1e-6));
  CHECK(boxes->contacts.size() == 2);
  CHECK(boxes->drives == std::vector<std::string>{"\"ram\""});
}

TEST_CASE("in space: a drive against a stop on its own coordinate is a jam from its begin on, by every integrator") {
  spatial::Scene s;
  const BodyId crank = s.body({.name = "crank", .inertia = askew_inertia(), .position = 0.5 * kAlong});
  const spatial::Revolute pin{"pin", kGround, crank, {0, 0, 0}, -0.5 * kAlong, kAcross, kAcross, kAlong, kAlong};
  s.joint(pin);
  s.joint(spatial::Drive{"motor", pin.angle(), {.rate_of_change = 5}});
  s.contact(spatial::Limit{"stop", pin.angle(), spatial::Limit::Side::upper, 0.3, {}});
  const SpatialSystem system(s);
  for (const std::string_view scheme : {"moreau-jean", "stewart-trinkle", "anitescu-potra", "paoli-schatzman",
                                        "generalized-alpha", "rattle", "adaptive", "event-driven"}) {
    CAPTURE(scheme);
    const Run r = simulate(*make_integrator(scheme, system), *make_solver("auto"), {.step = 1e-3, .duration = 0.064});
    CHECK(r.status == Status::infeasible);  // 0.02 rad behind the stop
    CHECK(r.why == "jammed: drive \"motor\", contact \"stop\" leave no motion; since t = 0.06");
    CHECK(r.final.t < 0.0625);
  }
}

TEST_CASE(
    "in space: a state far outside of its clearances is no proof of a jam where the motion from the start is none") {
  const auto scene = std::get<spatial::Scene>(read_any_scene(ORTHANT_TEST_DATA "/ball_out_of_socket.toml"));
  const SpatialSystem system(scene);
  const Run r = simulate(*make_integrator("anitescu-potra", system), *make_solver("auto"),
                         {.step = scene.step, .duration = scene.duration});
  CHECK(r.max_penetration > 1e-2);
  CHECK(r.status != Status::infeasible);
  CHECK(!JamSearchOf<Spatial>(system).find(system.initial_state(), scene.duration).has_value());
}
