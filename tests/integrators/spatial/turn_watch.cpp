// Angles in space that springs and limits read: right within half a turn of their middle, and never wrong without a
// word.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <cmath>
#include <optional>

using namespace orthant;

namespace {

constexpr std::string_view kAllEight[] = {"moreau-jean",       "stewart-trinkle", "anitescu-potra", "paoli-schatzman",
                                          "generalized-alpha", "rattle",          "adaptive",       "event-driven"};

/// A rotor on the joint "hinge".
spatial::Scene rotor(double omega, const std::string& elements) {
  return std::get<spatial::Scene>(
      parse_any_scene("dimension = 3\n[[body]]\nname = 'rotor'\nmass = 1\ninertia = 0.01\n"
                      "omega = [0, 0, " +
                          std::to_string(omega) +
                          "]\n[[joint]]\ntype = 'revolute'\nname = 'hinge'\n"
                          "bodies = ['ground', 'rotor']\naxis = [0, 0, 1]\n" +
                          elements,
                      {}, "rotor"));
}
const std::string kTorsion = "[[spring]]\ntype = 'joint'\nname = 'torsion'\njoint = 'hinge'\nstiffness = 0.01\n";
std::string stop(const std::string& bounds) {
  return "[[contact]]\ntype = 'limit'\nname = 'stop'\njoint = 'hinge'\ne_n = 0.5\n" + bounds;
}

struct Turned {
  Run run;
  double angle = 0;  // [rad] at the end, over full turns
};
Turned turned_by(const spatial::Scene& scene, std::string_view integrator, double step, double duration,
                 const Restart& restart = {}) {
  const SpatialSystem system(scene);
  const auto scheme = make_integrator(integrator, system);
  const auto solver = make_solver("auto");
  const spatial::Angle angle = std::get<spatial::Revolute>(system.scene().joints[0]).angle();
  spatial::Unwrapped turns;
  Turned all;
  all.run = simulate(
      *scheme, *solver, {.step = step, .duration = duration},
      [&](const SpatialSample& m) {
        const auto k = poses_of(system, m.state);
        all.angle = turns.add(m.state.t, angle.value(k), apply(angle.row(k), m.state.v.data()));
      },
      restart);
  return all;
}

}  // namespace

TEST_CASE(
    "a torsion spring in space: 3 sin t is followed, beyond half a turn every integrator ends the run and says why") {
  for (const std::string_view integrator : kAllEight) {
    CAPTURE(integrator);
    const Turned within = turned_by(rotor(3, kTorsion), integrator, 1e-2, 2);
    INFO(within.run.why);
    CHECK(within.run.status == Status::solved);
    CHECK(std::abs(within.angle - 3 * std::sin(2.0)) < 0.05);
    const Turned beyond = turned_by(rotor(4, kTorsion), integrator, 1e-2, 2);
    CHECK(beyond.run.status == Status::numerical_error);
    INFO(beyond.run.why);
    CHECK(beyond.run.why.find("angle of joint \"hinge\", which spring \"torsion\" reads, has turned to 3.1") == 4);
    CHECK(std::abs(beyond.run.final.t - std::asin(std::acos(-1.0) / 4)) < 0.05);  // 4 sin t = π
  }
}

TEST_CASE("a limit in space on one side: a rotor that turns away is free for half a turn, then the run ends") {
  for (const std::string_view integrator : kAllEight) {
    CAPTURE(integrator);
    const Turned free = turned_by(rotor(-1, stop("upper = 1\n")), integrator, 1e-2, 2);
    CHECK(free.run.status == Status::solved);
    CHECK(std::abs(free.angle + 2) < 1e-9);
    const Turned beyond = turned_by(rotor(-4, stop("upper = 1\n")), integrator, 1e-2, 2);
    CHECK(beyond.run.status == Status::numerical_error);
    INFO(beyond.run.why);  // a position-level scheme has thrown it back in that step
    CHECK(beyond.run.why.find("the angle of joint \"hinge\", which limit \"stop\" reads,") == 0);
    CHECK(std::abs(beyond.run.final.t - (std::acos(-1.0) - 1) / 4) < 0.05);
  }
}

TEST_CASE("limits in space nearly a full turn apart: a rotor between them is right, or its run is not solved") {
  for (const std::string_view integrator : kAllEight)
    for (const double step : {0.1, 1e-2, 1e-3}) {
      CAPTURE(integrator);
      CAPTURE(step);
      const Turned fast = turned_by(rotor(30, stop("lower = -3.1\nupper = 3.1\n")), integrator, step, 0.5);
      INFO(fast.run.why);
      if (fast.run.status == Status::solved)
        CHECK(std::abs(fast.angle + 2.85) < 0.3);
      else
        CHECK(fast.run.status == Status::numerical_error);
    }
}

TEST_CASE("a step of fixed length in which an angle in space may turn by half a turn ends the run") {
  for (const std::string_view integrator : kAllEight) {
    CAPTURE(integrator);
    const Turned fast = turned_by(rotor(30, stop("lower = -3\nupper = 3\n")), integrator, 0.08, 0.08);
    const bool divides = integrator == "adaptive" || integrator == "event-driven";
    CHECK(fast.run.status == (divides ? Status::solved : Status::numerical_error));
    INFO(fast.run.why);
    CHECK((fast.run.why.find("so that its turns cannot be counted: must be a smaller step") != std::string::npos) !=
          divides);
  }
}

TEST_CASE("limits in space beyond half a turn from 0: reached from the start, and from a checkpoint behind it") {
  const spatial::Scene scene = rotor(1, stop("lower = -0.1\nupper = 4.5\n"));
  for (const std::string_view integrator : kAllEight) {
    CAPTURE(integrator);
    std::string kept;
    const Restart saving{.every = 40, .save = [&](const std::string& bytes) { kept = bytes; }, .from = ""};
    const Turned whole = turned_by(scene, integrator, 0.1, 4.2, saving);
    INFO(whole.run.why);
    REQUIRE(whole.run.status == Status::solved);
    CHECK(std::abs(whole.angle - 4.2) < 1e-9);
    const Turned rest = turned_by(scene, integrator, 0.1, 4.2, {.every = 0, .save = {}, .from = kept});
    INFO(rest.run.why);
    CHECK(rest.run.status == Status::solved);
    CHECK(rest.run.final.q == whole.run.final.q);
  }
}
