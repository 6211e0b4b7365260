#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/run_fields.h>
#include <orthant/integrators/step/projection.h>
#include <orthant/integrators/step/pulley_watch.h>
#include <orthant/integrators/step/rotation_watch.h>
#include <orthant/integrators/step/turn_watch.h>

#include <chrono>
#include <cmath>

namespace orthant {
namespace {

using WallClock = std::chrono::steady_clock;

/// Sums impulses between records, and times the recorder so that it can be taken off.
template <class Space> class Recording {
 public:
  using Integrator = IntegratorOf<Space>;
  using Impulse = ImpulseOf<Space>;

  Recording(const RecorderOf<Space>& record, long every, const SystemOf<Space>& system)
      : record_(record),
        every_(every),
        sum_(static_cast<std::size_t>(system.contacts())),
        friction_(system.scene().frictions.size()) {}

  void add(long steps, bool last, const State& x, const StepReport& report, const Integrator& integrator) {
    if (!record_) return;
    const auto begin = WallClock::now();
    take(integrator);
    if (steps % every_ == 0 || last) write(x, report, integrator.gaps(), integrator.pairs());
    seconds += std::chrono::duration<double>(WallClock::now() - begin).count();
  }
  /// Where a failed step left the run, if that is not there already.
  void end(bool moved, const State& x, const StepReport& report, const Integrator& integrator) {
    if (!record_ || x.t == written_) return;
    if (moved) {
      take(integrator);
      std::erase_if(events_, [&](const Event& event) { return event.t > x.t; });  // of a motion that failed
      std::ranges::stable_sort(events_, {}, &Event::t);
    }
    write(x, report, integrator.gaps(), moved ? integrator.pairs() : std::span<const Pair>());
  }
  void write(const State& x, const StepReport& report, const Eigen::VectorXd& gaps, std::span<const Pair> pairs = {}) {
    if (!record_) return;
    record_({x, report, gaps, sum_, friction_, events_, pairs});
    written_ = x.t;
    events_.clear();
    std::fill(sum_.begin(), sum_.end(), Impulse{});
    std::fill(friction_.begin(), friction_.end(), 0.0);
  }

  void remember(CheckpointData& memory) { memory(written_, sum_, friction_, events_); }

  double seconds = 0;

 private:
  void take(const Integrator& integrator) {
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      sum_[i].normal += integrator.impulses()[i].normal;
      sum_[i].tangent += integrator.impulses()[i].tangent;
    }
    for (std::size_t i = 0; i < friction_.size(); ++i) friction_[i] += integrator.frictions()[i];
    events_.insert(events_.end(), integrator.events().begin(), integrator.events().end());
  }

  const RecorderOf<Space>& record_;
  long every_;
  double written_ = -kInf;  // [s] time of the last record
  std::vector<Impulse> sum_;
  std::vector<double> friction_;
  std::vector<Event> events_;
};

/// Time limit and cancellation of a run, set on its integrator and solver, which get back their own at the end; without
/// cost where there is no limit.
template <class Space> class Watchdog {
 public:
  using Integrator = IntegratorOf<Space>;

  Watchdog(const Clock& clock, Integrator& integrator, Solver& solver)
      : on_(clock.time_limit < kInf || clock.cancel != nullptr), integrator_(integrator), solver_(solver) {
    if (!on_) return;
    budget_before_ = integrator_.budget(), cancel_before_ = solver_.cancel(), outer_before_ = solver_.outer_budget();
    budget_.start(clock.time_limit, clock.cancel);
    integrator_.set_budget(&budget_);
    solver_.set_cancel(clock.cancel), solver_.set_outer_budget(&budget_);
  }
  ~Watchdog() {
    if (!on_) return;
    integrator_.set_budget(budget_before_);
    solver_.set_cancel(cancel_before_);
    solver_.set_outer_budget(outer_before_);
  }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  /// Asked before each step: true when the run is over.
  bool barks(Status& status) {
    if (!on_) return false;
    if (!budget_.exhausted()) return false;
    status = budget_.cancelled() ? Status::cancelled : Status::time_limit;
    return true;
  }

 private:
  bool on_;
  Budget budget_;
  Integrator& integrator_;
  Solver& solver_;
  const Budget* budget_before_ = nullptr;  // the caller's
  const std::atomic<bool>* cancel_before_ = nullptr;
  const Budget* outer_before_ = nullptr;
};

/// Why the solver has not taken the last problem; empty: it has, or there was none.
template <class Space> std::string refusal_of(Solver& solver, const IntegratorOf<Space>& integrator, Status status) {
  const bool refused = status == Status::unsupported && integrator.problem().size() > 0;
  return refused ? solver.refusal(integrator.problem()) : std::string();
}

/// Directions that are lost within a step, of schemes of fixed step; those that divide their step watch them within it.
/// In the plane: of taut ropes (pulley_watch.h). In space: angles that turn (turn_watch.h), and the error of free
/// rotation (rotation_watch.h).
template <class Space> class DirectionWatch {
 public:
  DirectionWatch(const IntegratorOf<Space>& integrator, const State& start)
      : pulleys_(integrator, start), inner_(integrator.controls_step()) {}
  bool admits(double /*h*/, const State& x) {
    if (!inner_) return pulleys_.admits(x);
    pulleys_.follow(x);  // for explains()
    return true;
  }
  bool explains(const State& x, double h) { return pulleys_.explains(x, h); }
  const std::string& why() const { return pulleys_.why(); }
  void tell(Run& /*run*/) const {}
  void remember(CheckpointData& memory) { memory(pulleys_); }

 private:
  PulleyWatch pulleys_;
  bool inner_;  // it watches them within its steps
};
template <> class DirectionWatch<Spatial> {
 public:
  DirectionWatch(const IntegratorOf<Spatial>& integrator, const State& start) {
    if (integrator.controls_step()) return;
    turns_.emplace(integrator.system(), kMostTurn).follow(start.t, start.q, start.v);
    rotations_.emplace(integrator.system(), start);
  }
  bool admits(double h, const State& x) {
    if (rotations_) rotations_->follow(h, x);
    return !turns_ || turns_->follow(x.t, x.q, x.v);
  }
  bool explains(const State& /*x*/, double /*h*/) const { return false; }
  const std::string& why() const { return turns_->why(); }
  void tell(Run& run) const {
    if (rotations_) run.rotation_error = rotations_->error(), run.rotation_body = rotations_->body();
  }
  void remember(CheckpointData& memory) {
    if (turns_) memory(*turns_, *rotations_);
  }

 private:
  static constexpr double kMostTurn = 1.5;  // [rad] in a step: with both signs less than half a turn
  std::optional<TurnWatch> turns_;
  std::optional<RotationWatch> rotations_;
};

void note(const StepReport& report, Run& run) {
  run.energy_rises += report.energy_rises;
  if (report.energy_rise > run.max_energy_rise) {
    run.max_energy_rise = report.energy_rise;
    run.max_energy_rise_time = std::min(report.energy_rise_time, run.final.t);
  }
  if (report.passage.width > 0 && run.passages++ == 0)
    run.first_passage = report.passage, run.first_passage_time = run.final.t;
  if (report.rounded > 0 && run.rounded_steps++ == 0)
    run.first_rounded = words_of(report.miss), run.first_rounded_time = run.final.t;
  if (report.plastic > 0 && run.plastic_steps++ == 0) run.first_plastic_time = run.final.t;
  if (report.undetermined > 0 && run.undetermined_steps++ == 0) run.first_undetermined_time = run.final.t;
  run.max_joint_residual = std::max(run.max_joint_residual, report.joint_residual);
  if (report.penetration > run.max_penetration) {
    run.max_penetration = report.penetration;
    run.max_penetration_time = run.final.t;
  }
  run.max_lcp_residual = std::max(run.max_lcp_residual, report.lcp_residual);
  run.max_joint_rate = std::max(run.max_joint_rate, report.joint_rate);
  run.accepted += report.accepted;
  run.crossings += report.crossings;
  run.error_estimate += report.error_estimate;
  run.rejected += report.rejected;
  run.lcp_solves += report.lcp_solves;
  run.lcp_iterations += report.lcp_iterations;
}

void remember(Run& run, CheckpointData& memory) {
  memory(run.final, run.first_passage, run.first_rounded);
  visit_fields(run, [&](const char*, const char*, const char*, auto& value) { memory(value); });
}

/// Of a run at the end of a step, for Restart. The clock is told apart: a run goes on only as it was begun.
template <class Space, class Watch> void remember(const Clock& clock, Run& run, Recording<Space>& recording,
                                                  IntegratorOf<Space>& integrator, Watch& watch,
                                                  DirectionWatch<Space>& directions, CheckpointData& memory) {
  Clock same = clock;
  memory(same.step, same.duration, same.every);
  if (same.step != clock.step || same.duration != clock.duration || same.every != clock.every)
    throw std::invalid_argument("checkpoint: was made with step = " + detail::text_of(same.step) +
                                ", duration = " + detail::text_of(same.duration) +
                                ", every = " + std::to_string(same.every) + ": must be those of this run");
  remember(run, memory);
  memory(recording, integrator, watch, directions);
}

/// A start that breaks the joints, onto them: position, then velocity, in the metric of M (projection.h). One that
/// keeps them to 1e-9 stays as it is; so does one from which they cannot be closed, for the first step to say so.
template <class Space> void close_joints(const SystemOf<Space>& system, TermsOf<Space>& terms, State& x) {
  constexpr double kClosed = 1e-9;
  constexpr int kPasses = 20;
  if (system.joint_rows() == 0) return;
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_residual(system, terms);
  evaluate_joint_rows(system, terms);
  Eigen::VectorXd rate(terms.phi.size());
  for (Index i = 0; i < rate.size(); ++i) rate[i] = terms.missing_rate(i, x.v);
  Magnitudes far(system.assembly());
  if (joints_off(terms, x.q, far) <= kClosed && off_by(terms, x.v, rate) <= kClosed) return;
  ProjectionOf<Space> projection(system);
  State closed = x;
  double left = kInf;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double now = projection.position(x.t, terms, closed.q);
    if (!(now < left)) break;
    left = now;
  }
  if (!(projection.off(terms, closed.q) <= kJointsHold)) return;
  projection.velocity(terms, closed.v);
  x = closed;
}

/// Whether a step that failed midway left the joints open, or the state not finite: it reached no state to speak of.
template <class Space>
bool breaks_joints(const SystemOf<Space>& system, TermsOf<Space>& terms, const State& before, const State& x) {
  constexpr double kOpen = 1e-6;  // of 1 m and the coordinates before; those that are followed are off by 1e-9 at most
  if (!x.q.allFinite() || !x.v.allFinite()) return true;
  if (system.joint_rows() == 0) return false;
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_residual(system, terms);
  Magnitudes far(system.assembly());
  return !(joints_off(terms, before.q, far) <= kOpen);
}

}  // namespace

void close_joints(const System& system, State& x) {
  Terms terms(system);
  close_joints(system, terms, x);
}

void check(const Clock& clock) {
  const auto refuse = [](const char* field, const std::string& value, const char* rule) {
    throw std::invalid_argument(std::string(field) + " = " + value + ": " + rule);
  };
  if (!(clock.step > 0) || !std::isfinite(clock.step))
    refuse("step", detail::text_of(clock.step), "must be > 0 and finite");
  if (!(clock.duration > 0) || !std::isfinite(clock.duration))
    refuse("duration", detail::text_of(clock.duration), "must be > 0 and finite");
  if (!(clock.time_limit >= 0)) refuse("time_limit", detail::text_of(clock.time_limit), "must be >= 0");
  if (clock.every < 1) refuse("every", std::to_string(clock.every), "must be >= 1");
  if (clock.duration / clock.step > 1e15)
    refuse("step", detail::text_of(clock.step), "must be at least duration / 1e15");
}

/// One function: the loop over the steps, with each of its ends.
template <class Space> Run simulate(IntegratorOf<Space>& integrator, Solver& solver, const Clock& clock,
                                    const std::type_identity_t<RecorderOf<Space>>& record, const Restart& restart) {
  check(clock);
  if (restart.every < 0 || (restart.every > 0 && !restart.save))
    throw std::invalid_argument("restart.every = " + std::to_string(restart.every) +
                                ": must be >= 0, and with it something that saves");
  integrator.check_pyramids(solver);
  const SystemOf<Space>& system = integrator.system();
  Run run;
  run.final = system.initial_state();
  State& x = run.final;
  TermsOf<Space> start(system);
  close_joints(system, start, x);
  run.energy_initial = energy(system, x);

  Recording<Space> recording(record, clock.every, system);
  set_poses(system, x.t, x.q, start.at);
  BroadPhaseOf<Space>(system).find(Eigen::VectorXd::Zero(system.dof()), start);
  evaluate_gaps(system, start);
  MotionWatchOf<Space> watch(integrator, x, start.gap);
  DirectionWatch<Space> directions(integrator, x);
  if (restart.from.empty()) {
    recording.write(x, StepReport::solved(), start.gap);
  } else {
    CheckpointData memory(restart.from);
    remember(clock, run, recording, integrator, watch, directions, memory);
    memory.end();
    if (x.q.size() != system.coordinates() || x.v.size() != system.dof())
      throw std::invalid_argument("checkpoint: is of another scene");
  }
  const double seconds_before = run.seconds;
  State before;           // the step, where the watch reads it
  Eigen::VectorXd there;  // coordinates of a failed step's end, moved by the search for jams

  // A remainder below a billionth of a step is the rounding of duration / step.
  const auto whole = static_cast<long>(std::floor(clock.duration / clock.step * (1 + 1e-12) + 1e-9));
  const double rest = clock.duration - static_cast<double>(whole) * clock.step;
  const long total = whole + (whole == 0 || rest > 1e-9 * clock.step ? 1 : 0);
  const auto begin = WallClock::now();
  Watchdog<Space> watchdog(clock, integrator, solver);
  for (long k = run.steps; k < total; ++k) {
    if (watchdog.barks(run.status)) {
      recording.end(false, x, {}, integrator);
      break;
    }
    const double t = x.t, h = k < whole ? clock.step : rest;
    if (watch.measures_work() || integrator.controls_step() || clock.rounded == Rounded::stop) before = x;
    const StepReport report = integrator.step(h, solver, x);
    if (report.status != Status::solved) {
      run.status = report.status;
      run.why = integrator.why();
      if (watch.explains(x, h, report.status))
        run.status = watch.status(), run.why = watch.why();
      else if (directions.explains(x, h))
        run.status = Status::numerical_error, run.why = directions.why();
      else if (report.status == Status::infeasible && run.why.starts_with("jammed"))
        run.why += since(x.t);
      else if (const std::string refusal = refusal_of(solver, integrator, report.status); !refusal.empty())
        run.why += (run.why.empty() ? "" : "; ") + ("the solver cannot take it: " + refusal);
      if (watch.jammed() && watch.measures_work() && !JamSearchOf<Space>(system).fits(x.t, there = x.q))
        x = before;  // in a jam there is no motion
      if (!watch.jammed() && integrator.controls_step() && x.t != t && breaks_joints(system, start, before, x))
        x = before;
      const bool moved = x.t != t;  // a scheme that controls its step came some way
      if (moved) {
        note(report, run);
        run.events += std::ranges::count_if(integrator.events(), [&](const Event& event) { return event.t <= x.t; });
      }
      recording.end(moved, x, report, integrator);
      break;
    }
    if (report.rounded > 0 && clock.rounded == Rounded::stop) {
      x = before;
      run.status = Status::rounded;
      run.why = "the step's problem is rounded only: " + words_of(report.miss);
      recording.end(false, x, report, integrator);
      break;
    }
    x.t = k + 1 < total ? static_cast<double>(k + 1) * clock.step : clock.duration;  // no summed rounding
    if (!directions.admits(h, x)) {
      run.status = Status::numerical_error, run.why = directions.why();
      note(report, run);
      recording.end(true, x, report, integrator);
      break;
    }
    if (!watch.admits(before, x, h, report, k + 1 == total)) {
      run.status = watch.status(), run.why = watch.why();
      if (watch.jammed()) x = before;
      note(report, run);
      recording.end(false, x, report, integrator);
      break;
    }
    run.steps = k + 1;
    note(report, run);
    run.events += static_cast<long>(integrator.events().size());
    if (clock.reached != nullptr) {
      clock.reached->t.store(x.t, std::memory_order_relaxed);
      clock.reached->events.store(run.events, std::memory_order_relaxed);
    }
    recording.add(run.steps, run.steps == total, x, report, integrator);
    if (restart.every > 0 && run.steps % restart.every == 0) {
      const auto saving = WallClock::now();
      CheckpointData memory;
      remember(clock, run, recording, integrator, watch, directions, memory);
      restart.save(memory.bytes());
      recording.seconds += std::chrono::duration<double>(WallClock::now() - saving).count();
    }
  }
  if (run.status == Status::not_run) run.status = Status::solved;
  run.seconds = seconds_before + std::chrono::duration<double>(WallClock::now() - begin).count() - recording.seconds;
  run.energy_final = energy(system, x);
  run.motion = watch.motion();
  directions.tell(run);
  return run;
}

template Run simulate(IntegratorOf<Planar>&, Solver&, const Clock&, const RecorderOf<Planar>&, const Restart&);
template Run simulate(IntegratorOf<Spatial>&, Solver&, const Clock&, const RecorderOf<Spatial>&, const Restart&);

}  // namespace orthant
