// tests/integrators/derivatives/motion_trials.h — scene texts at other values of a key, for derivatives of motions.
#pragma once

#include <orthant/integrators/event_driven/event_driven.h>

#include "tests/integrators/derivatives/run_trials.h"

#include <algorithm>
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

/// Checks all of q and v at the end, relative to the largest; differences to one side only where `side` is 1 or −1.
inline void check_motion(const std::string& text, const std::vector<MotionTrial>& trials, double duration,
                         double tolerance, int side = 0) {
  const System system(from_text(text)({}));
  const auto solver = make_solver("auto");
  const MotionTangent tangent = differentiate_motion(system, parameters_of(text, trials), {}, *solver, duration);
  REQUIRE(tangent.status == Status::solved);
  CHECK(tangent.none == "");
  const Clock clock{.step = duration, .duration = duration};
  for (std::size_t j = 0; j < trials.size(); ++j) {
    INFO(trials[j].key);
    const double step = trials[j].step;
    const double low = side > 0 ? 0 : -step, high = side < 0 ? 0 : step;
    const State a = end_of(from_text(text)({set_of(trials[j], trials[j].value + low)}), "event-driven", clock);
    const State b = end_of(from_text(text)({set_of(trials[j], trials[j].value + high)}), "event-driven", clock);
    const Eigen::VectorXd q = (b.q - a.q) / (high - low), v = (b.v - a.v) / (high - low);
    const auto column = static_cast<Index>(j);
    const double scale = std::max(q.lpNorm<Eigen::Infinity>(), v.lpNorm<Eigen::Infinity>());
    CHECK(scale > 0);
    CHECK((q - tangent.q.col(column)).lpNorm<Eigen::Infinity>() <= tolerance * scale);
    CHECK((v - tangent.v.col(column)).lpNorm<Eigen::Infinity>() <= tolerance * scale);
  }
}

}  // namespace orthant
