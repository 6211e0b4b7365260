// Gears and racks with backlash: impacts across the play at their exact times, in every integrator; no tooth is skipped
// silently.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/gear_train.h>

#include <doctest/doctest.h>

#include <cmath>
#include <string>

using namespace orthant;

namespace {

constexpr std::string_view kToothed[] = {"moreau-jean",       "stewart-trinkle", "anitescu-potra", "paoli-schatzman",
                                         "generalized-alpha", "rattle",          "adaptive",       "event-driven"};

spatial::Scene toothed_scene(const std::string& text) {
  return std::get<spatial::Scene>(parse_any_scene(text, {}, "teeth.toml"));
}

/// Two wheels on parallel axes, 20 teeth on 30, and their rates.
std::string two_wheels(double first, double second) {
  const auto wheel = [](const std::string& name, double x, double J, double omega) {
    const std::string at = std::to_string(x);
    return "[[body]]\nname = '" + name + "'\nmass = 1\ninertia = " + std::to_string(J) + "\nposition = [" + at +
           ", 0, 0]\nomega = [0, 0, " + std::to_string(omega) + "]\n[[joint]]\nname = '" + name +
           "_axis'\ntype = 'revolute'\nbodies = ['ground', '" + name + "']\npoint_a = [" + at +
           ", 0, 0]\naxis = [0, 0, 1]\n";
  };
  return "dimension = 3\n" + wheel("one", 0, 0.02, first) + wheel("two", 0.1, 0.05, second);
}
std::string playing_teeth(double play, double e) {
  return "[[contact]]\nname = 'teeth'\ntype = 'backlash'\njoints = ['one_axis', 'two_axis']\nteeth = [20, 30]\nplay "
         "= " +
         std::to_string(play) + "\ne_n = " + std::to_string(e) + "\n";
}

double revolute_angle(const SpatialSystem& system, const State& state, std::size_t joint) {
  return std::get<spatial::Revolute>(system.scene().joints[joint]).angle().value(poses_of(system, state));
}

}  // namespace

TEST_CASE("a driven wheel strikes the free one across the play, ever more slowly: exact times of impact") {
  // v = 3 rad/s at the second wheel, which starts between the flanks: impacts at p/(2 v), then p/(e v), p/(e² v) later.
  const double v = 3, play = 0.02, e = 0.5, end = 0.05;
  // The second wheel is thrown ahead of the mesh, which turns at −v, and falls back behind it.
  double expected = 0, now = 0, rate = 0, slip = v;  // slip: of the gap that closes
  for (double next = play / 2 / v; next < end; next = now + play / slip) {
    expected += rate * (next - now), now = next;
    slip *= e;
    rate = rate > -v ? -v - slip : -v + slip;
  }
  expected += rate * (end - now);
  for (const std::string_view integrator : kToothed) {
    CAPTURE(integrator);
    const SpatialSystem system(toothed_scene(
        two_wheels(4.5, 0) + "[[joint]]\ntype = 'drive'\njoint = 'one_axis'\nrate = 4.5\n" + playing_teeth(play, e)));
    const bool exact = integrator == "event-driven";
    const Run run = run_in_space(system, integrator, exact ? 1e-2 : 1e-5, end);
    INFO(run.why);
    REQUIRE(run.status == Status::solved);
    const double off = std::abs(revolute_angle(system, run.final, 1) - expected);
    MESSAGE(integrator << ": " << off);
    CHECK(off < (exact ? 1e-12 : integrator == "adaptive" ? 1e-7 : 2e-4));
    if (exact) CHECK(run.events == 3);
  }
}

TEST_CASE("free wheels in mesh with play keep J1 w1 + ratio J2 w2, and with e = 1 their energy") {
  const double ratio = -2.0 / 3;
  for (const std::string_view integrator : kToothed) {
    CAPTURE(integrator);
    const SpatialSystem system(toothed_scene(two_wheels(5, 2) + playing_teeth(0.03, 1)));
    const Run run = run_in_space(system, integrator, 1e-4, 0.5);
    INFO(run.why);
    REQUIRE(run.status == Status::solved);
    const double one = world_omega(system, run.final, 0).z(), two = world_omega(system, run.final, 1).z();
    // The impulse of the mesh is λ on the second, −ratio λ on the first wheel.
    CHECK(std::abs(0.02 * one + ratio * 0.05 * two - (0.02 * 5 + ratio * 0.05 * 2)) < 1e-10);
    if (integrator != "stewart-trinkle" && integrator != "anitescu-potra" && integrator != "generalized-alpha")
      CHECK(std::abs(0.02 * one * one + 0.05 * two * two - (0.02 * 25 + 0.05 * 4)) < 1e-6);
  }
}

TEST_CASE("a gear train with play: the flanks hold, and no energy comes up") {
  const SpatialSystem system(gear_train({.wheels = 4, .brake = 0}));
  for (const std::string_view integrator : kToothed) {
    CAPTURE(integrator);
    const Run run = run_in_space(system, integrator, 1e-4, 0.6);
    INFO(run.why);
    REQUIRE(run.status == Status::solved);
    CHECK(run.max_penetration < 2e-3);
    if (integrator != "paoli-schatzman") CHECK(run.energy_rises == 0);
  }
}

TEST_CASE("a step that would skip a tooth ends the run with the contact's name") {
  for (const std::string_view integrator : {"moreau-jean", "rattle"}) {
    CAPTURE(integrator);
    // 40 rad/s in 0.1 s: four radians of the first wheel, of whose mesh 2π/3 are from tooth to tooth.
    const SpatialSystem system(toothed_scene(two_wheels(40, 40) + playing_teeth(0.03, 0)));
    const auto scheme = make_integrator(integrator, system);
    const auto solver = make_solver("auto");
    const Run run = simulate(*scheme, *solver, {.step = 0.1, .duration = 1}, [](const SpatialSample&) {});
    CHECK(run.status == Status::numerical_error);
    INFO(run.why);
    CHECK(run.why.find("play of contact \"teeth_lower\"") != std::string::npos);
  }
}
