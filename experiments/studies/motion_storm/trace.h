// experiments/studies/motion_storm/trace.h — a recorded run, made in a process of its own.
#pragma once

#include "experiments/studies/motion_storm/space.h"

#include <orthant/integrators/simulate.h>

#include <string>
#include <vector>

namespace orthant::motion_storm {

/// A run with the states of its ends of steps. Of `run` only what is read here comes back: status, why, energy_rises,
/// max_energy_rise, passages, crossings, error_estimate, motion.energy_defect and energy_scale.
struct Trace {
  std::string refused;  // the scheme does not take this scene, in its words
  std::string threw;    // an exception or a signal, in place of a status
  bool late = false;    // stopped by force: it did not keep to its limit
  double seconds = 0;   // of the processor
  Run run;
  std::vector<State> rows;
  std::vector<Event> events;    // located ones, in order of time
  std::vector<double> belt;     // [J] bound of the work of moving surfaces up to each row
  std::vector<double> pressed;  // [N s] sum of all normal impulses in the step that ends at each row

  bool ran() const { return refused.empty() && threw.empty() && !late; }
  bool solved() const { return ran() && run.status == Status::solved; }
  double end() const { return rows.empty() ? 0 : rows.back().t; }
};

/// `step` [s] and `limit` [s] of wall time; the duration is the scene's. More than a second of the processor past
/// `limit` and `grace` [s], or 30 times that of wall time, ends the run: late.
Trace trace(const Scene& scene, const std::string& spec, double step, double limit, double grace);
Trace trace(const spatial::Scene& scene, const std::string& spec, double step, double limit, double grace);

/// Whether two contacts strike one after the other within a step: there they strike at once, by another law. Only what
/// exchanges a thousandth of the largest impulse, or more, counts.
bool strikes_in_turn(const std::vector<Event>& events, double step);

}  // namespace orthant::motion_storm
