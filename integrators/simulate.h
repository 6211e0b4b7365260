// integrators/simulate.h — simulation loop over the steps, and its record of the run.
#pragma once

#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/admissible.h>

#include <array>
#include <atomic>
#include <functional>
#include <type_traits>

namespace orthant {

struct Run {
  Status status = Status::not_run;              // of the last step; solved: all of them are
  std::string why;                              // in words, where the status does not say it all
  State final;                                  // where the run ended; on failure the state before the failed step
  long steps = 0;                               // completed
  double seconds = 0;                           // wall time of the steps alone, recording excluded
  double energy_initial = 0, energy_final = 0;  // [J]
  double max_joint_residual = 0;                // [m, rad] over all ends of steps
  double max_penetration = 0, max_penetration_time = 0;  // [m, s]
  double max_lcp_residual = 0;                           // [m/s]
  double max_joint_rate = 0;        // [m/s, rad/s], of schemes that satisfy the joints at velocity level
  long accepted = 0, rejected = 0;  // inner steps
  long lcp_solves = 0, lcp_iterations = 0;
  long rounded_steps = 0;                 // steps with a problem that is rounded only (Status::rounded)
  double first_rounded_time = kInf;       // [s] the end of the first such step; infinity: there is none
  std::string first_rounded;              // what it misses, in words
  long plastic_steps = 0;                 // steps with impacts that friction kept from rebounding (formulate.h)
  double first_plastic_time = kInf;       // [s] the end of the first such step; infinity: there is none
  long undetermined_steps = 0;            // steps with friction by a share of load that rigid bodies do not determine
  double first_undetermined_time = kInf;  // [s] the end of the first such step; infinity: there is none
  long events = 0;                        // located
  long crossings = 0;                     // of crowds of events, see StepReport
  double error_estimate = 0;              // [m, rad] of the final q, see StepReport; 0: the scheme has none
  long energy_rises = 0;                  // impacts (impact.h) and crossings that raised it
  double max_energy_rise = 0, max_energy_rise_time = 0;  // [J] the most in one step; [s] its event, or the step's end
  Admissibility motion;                                  // overlaps and energy balance (step/admissible.h)
  double rotation_error = 0;       // [rad] estimated, of free rotation in space by fixed steps (step/rotation_watch.h)
  BodyId rotation_body = kGround;  // that has it
  long passages = 0;               // steps in which bodies passed through each other (tunnelling.h)
  Passage first_passage;
  double first_passage_time = kInf;  // [s] the end of that step; infinity: there is none
};

/// A moment of the run. Impulses (of frictions too) and events are those since the moment before, so that none is lost
/// between records.
template <class Space> struct RunSampleOf {
  const State& state;
  const StepReport& report;
  const Eigen::VectorXd& gaps;                    // one per contact [m]
  const std::vector<ImpulseOf<Space>>& impulses;  // one per contact [N s]
  const std::vector<double>& frictions;           // one per dry friction in joints [N m s, N s]
  std::span<const Event> events;                  // located, in order of time
  std::span<const Pair> pairs = {};  // of the last step: behind the listed contacts, where collisions are searched
};
using RunSample = RunSampleOf<Planar>;

template <class Space> using RecorderOf = std::function<void(const RunSampleOf<Space>&)>;
using Recorder = RecorderOf<Planar>;

/// How far a run has come, for another thread to show.
struct Reached {
  std::atomic<double> t = 0;  // [s]
  std::atomic<long> events = 0;
};

enum class Rounded { take, stop };  // a step with a problem that is rounded only: counted, or the end of the run
inline constexpr std::array<std::string_view, 2> kRoundedNames = {"take", "stop"};

struct Clock {
  double step = 1e-3;        // h > 0 [s]; the last step is shorter when the duration is no multiple of it
  double duration = 1;       // > 0 [s]
  long every = 1;            // record every so many steps, and the first and the last moment
  double time_limit = kInf;  // [s] of wall time; past it the run ends with Status::time_limit
  const std::atomic<bool>* cancel = nullptr;  // raised by another thread: the run ends with Status::cancelled
  Rounded rounded = Rounded::take;            // stop: the run ends before such a step, with Status::rounded
  Reached* reached = nullptr;                 // updated at the ends of steps
};

/// Checkpoints, saved periodically. A run that continues from one repeats the bits of the run that wrote it. Compared
/// with a run without checkpoints, sparse factorizations may differ by rounding, because pivots are chosen again.
struct Restart {
  long every = 0;                                      // steps between two savings; 0: none
  std::function<void(const std::string& bytes)> save;  // called with what to keep, at the ends of steps
  std::string from;                                    // such bytes, to go on from; empty: the start
};

/// Steps from the system's initial state; where that breaks joints, from the nearest state that keeps them, in the
/// metric of M (projection.h). Throws std::invalid_argument for a bad clock; a step that fails ends the run with its
/// status, and integrator.problem() is the problem that was not solved. With a time limit or a flag in `clock`, they
/// replace the solver's own during the run; within a step that looks at them only periodically, the run may end a
/// little late.
/// With restart.from the moments before it are not recorded again; bytes that do not fit throw std::invalid_argument.
/// In space overlaps and the energy balance are not watched (Run::motion stays empty).
template <class Space> Run simulate(IntegratorOf<Space>& integrator, Solver& solver, const Clock& clock,
                                    const std::type_identity_t<RecorderOf<Space>>& record = {},
                                    const Restart& restart = {});

/// Moves a start that breaks the joints onto them, as simulate() begins.
void close_joints(const System& system, State& x);

/// Throws std::invalid_argument naming field, value and rule.
void check(const Clock& clock);

}  // namespace orthant
