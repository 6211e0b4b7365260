// integrators/simulate.h — the loop over steps, and what is kept of it.
#pragma once

#include <orthant/integrators/integrator.h>

#include <functional>

namespace orthant {

struct Run {
  Status status = Status::solved;               // of the last step
  std::string why;                              // in words, where the status does not say it all
  State final;                                  // where the run ended; on failure the state before the failed step
  long steps = 0;                               // completed
  double seconds = 0;                           // wall time of the steps alone, recording excluded
  double energy_initial = 0, energy_final = 0;  // [J]
  double max_joint_residual = 0;                // [m, rad] over all ends of steps
  double max_penetration = 0;                   // [m]
  double max_lcp_residual = 0;                  // [m/s]
  double max_joint_rate = 0;                    // [m/s, rad/s], of schemes that satisfy the joints at velocity level
  long accepted = 0, rejected = 0;              // inner steps
  long lcp_solves = 0, lcp_iterations = 0;
  long events = 0;                                // located
  long energy_rises = 0;                          // steps in which impacts raised the energy (impact.h)
  double max_energy_rise = 0, max_rise_time = 0;  // [J] the most in one step, and the end of that step [s]
  long passages = 0;                              // steps in which bodies passed through each other (passing.h)
  Passage first_passage;
  double first_passage_time = 0;  // [s] the end of that step
};

/// A moment of the run. Impulses (of frictions too) and events are those since the moment before, so that none is lost
/// between records.
struct Moment {
  const State& state;
  const StepReport& report;
  const Eigen::VectorXd& gaps;           // one per contact [m]
  const std::vector<Impulse>& impulses;  // one per contact [N s]
  const std::vector<double>& frictions;  // one per dry friction in joints [N m s, N s]
  std::span<const Event> events;         // located, in order of time
};

using Recorder = std::function<void(const Moment&)>;

struct Clock {
  double step = 1e-3;   // h > 0 [s]; the last step is shorter when the duration is no multiple of it
  double duration = 1;  // > 0 [s]
  long every = 1;       // record every so many steps, besides the first and the last moment
};

/// Steps from the system's initial state; where that breaks joints, from the nearest state that keeps them, in the metric
/// of M (projection.h). Throws std::invalid_argument for a bad clock; a step that fails ends the run with its status, and
/// integrator.problem() is the problem that was not solved.
Run simulate(Integrator& integrator, Solver& solver, const Clock& clock, const Recorder& record = {});

/// Throws std::invalid_argument naming field, value and rule.
void check(const Clock& clock);

}  // namespace orthant
