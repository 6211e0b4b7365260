// tests/integrators/derivatives/motion_trials.h — scene texts at other values of a key, for derivatives of motions.
#pragma once

#include <orthant/integrators/event_driven/event_driven.h>

#include "tests/integrators/derivatives/run_trials.h"

#include <cstdio>
#include <string>
#include <vector>

namespace orthant {

/// A key of a scene text and its value there.
struct MotionTrial {
  std::string key, before, after;  // KEY=before VALUE after
  double value;
  double step = 1e-6;  // of differences
};

inline std::string set_of(const MotionTrial& trial, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return trial.key + "=" + trial.before + text + trial.after;
}

inline State end_of(const Scene& scene, const std::string& integrator, const Clock& clock) {
  const System system(scene);
  const auto solver = make_solver("auto");
  Run run;
  if (integrator == "moreau-jean") {
    MoreauJean method(system);
    run = simulate(method, *solver, clock);
  } else {
    EventDriven method(system);
    run = simulate(method, *solver, clock);
  }
  REQUIRE(run.status == Status::solved);
  return run.final;
}

/// Each a scene of `text` with one key set.
inline std::vector<RunParameter> parameters_of(const std::string& text, const std::vector<MotionTrial>& trials) {
  std::vector<RunParameter> parameters;
  for (const MotionTrial& trial : trials)
    parameters.push_back({trial.key, trial.value, [=](double x) { return from_text(text)({set_of(trial, x)}); }});
  return parameters;
}

}  // namespace orthant
