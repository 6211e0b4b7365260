// A tracked vehicle rolls as far as its links say, and its track keeps its length.
#include "experiments/studies/support/track.h"

#include <doctest/doctest.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <string>

using namespace orthant;

TEST_CASE("a tracked vehicle rolls one pitch a link, by two schemes") {
  const Track t{.links = 36, .speed = 0.5, .ramp = 0.5};
  for (const std::string scheme : {"moreau-jean", "stewart-trinkle"}) {
    CAPTURE(scheme);
    const System system(track(t));
    const auto integrator = make_integrator(scheme, system);
    const auto solver = make_solver("auto");
    const State start = system.initial_state();
    double least_height = kInf;
    const Run run = simulate(*integrator, *solver, {.step = 2e-3, .duration = t.ramp}, [&](const RunSample& moment) {
      for (BodyId link = 4; link < system.bodies(); ++link)
        least_height = std::min(least_height, moment.state.q[3 * link + 1]);
    });
    REQUIRE(run.status == Status::solved);
    CHECK(std::abs(run.final.q[0] - start.q[0] - 0.125) < 0.005);  // [m] half of speed × ramp
    CHECK(std::abs(run.final.v[0] - t.speed) < 0.05);
    CHECK(run.max_joint_residual < 1e-10);
    CHECK(least_height > 0.9 * t.pin);
  }
}

TEST_CASE("of a tightened track, no step's problem takes auto a second round") {
  const System system(track({.links = 60}));
  const auto integrator = make_integrator("moreau-jean", system);
  const auto solver = make_solver("auto");
  IterationLog log;
  solver->set_log(&log);
  State x = system.initial_state();
  for (int k = 0; k < 30; ++k) {
    CAPTURE(k);
    const StepReport report = integrator->step(1e-3, *solver, x);
    REQUIRE(report.status == Status::solved);
    for (const LogEntry& entry : log) CHECK_MESSAGE(entry.iteration == 0, entry.event);
  }
}
