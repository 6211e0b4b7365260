// Runs of the adaptive scheme to a tolerance, which must be solved.
#pragma once

#include "tests/support/runs.h"

#include <orthant/integrators/adaptive/adaptive.h>

#include <doctest/doctest.h>

namespace orthant {

/// In calls of `step`; 0: one call for all of it.
inline Run run_to(Scene scene, double duration, double tolerance, const Recorder& record = {}, double step = 0) {
  scene.duration = duration;
  const System system(scene);
  Adaptive scheme(system, {.rtol = tolerance, .atol = tolerance / 100});
  const auto solver = make_solver("lemke");
  Run r = simulate(scheme, *solver, {.step = step > 0 ? step : duration, .duration = duration}, record);
  INFO(r.why);
  REQUIRE(r.status == Status::solved);
  return r;
}

}  // namespace orthant
