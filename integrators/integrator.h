// integrators/integrator.h — integrator interface: one step, and its report.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/integrators/capabilities.h>
#include <orthant/integrators/checkpoint.h>
#include <orthant/integrators/event.h>
#include <orthant/integrators/solver_pool.h>
#include <orthant/integrators/step/tunnelling.h>
#include <orthant/solvers/solver.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

/// Of one call of step(): a scheme of fixed step takes it as it is, one that controls its step divides it.
struct StepReport {
  Status status = Status::not_run;  // of the last complementarity problem; solved when there was none
  double lcp_residual = 0;          // [m/s] the largest of those solved, as certify() measures it
  int lcp_rows = 0;                 // rows of the largest problem; 0: none was solved
  int lcp_solves = 0;
  int rounded = 0;             // problems that are rounded only (Status::rounded)
  Miss miss;                   // of the first of them
  int lcp_iterations = 0;      // of all of them
  int accepted = 1;            // inner steps
  int rejected = 0;            // inner steps done again with a smaller one
  double joint_residual = 0;   // max |Φ| at the end of the step [m, rad]
  double joint_rate = 0;       // max |G v| at the end of the step [m/s, rad/s], of schemes that satisfy it
  double penetration = 0;      // max(0, −gap) at the end of the step [m]
  int crossings = 0;           // of the inner steps: across crowds of events, to first order whatever the tolerance
  std::optional<double> work;  // [J] of drives, loads and belts, from schemes that measure it themselves (work_meter.h)
  double effort = 0;           // [J] likewise, the sum of the inner steps' absolute values
  double least_weight = kInf;  // [J] least potential energy of weight at inner steps; infinity: not measured
  double error_estimate =
      0;  // [m, rad] of q: sum over the inner steps of schemes that estimate it; the motion may magnify it
  int energy_rises = 0;            // impacts and crossings that added energy where they should not, see impact.h
  double energy_rise = 0;          // [J] the largest of them
  double energy_rise_time = kInf;  // [s] its time, from schemes that locate events; infinity: end of the step
  int plastic = 0;                 // problems that friction and restitution left without a solution, solved with e = 0
  int undetermined = 0;            // inner steps with friction by a share of load that rigid bodies do not determine
  Passage passage;                 // of bodies through each other, unseen, of schemes of fixed step

  /// A step that is solved so far.
  static StepReport solved(int accepted = 1) {
    StepReport report;
    report.status = Status::solved, report.accepted = accepted;
    return report;
  }

  void note_rise(double rise, double t, int times = 1) {
    energy_rises += rise > 0 ? times : 0;
    if (rise > energy_rise) energy_rise = rise, energy_rise_time = t;
  }

  /// Takes one more problem in; true: it has an answer, solved or rounded. `status` is solved in both cases.
  bool note(const Lcp& problem, const Solution& solution) {
    return note(static_cast<int>(problem.size()), solution.status, solution.residual, solution.iterations,
                solution.miss);
  }
  bool note(int rows, Status status_of_it, double residual, int iterations, const Miss& missed);
};

template <class Space> struct ImpulseOf {
  double normal = 0;
  Tangent<Space> tangent{};  // [N s]
};
using Impulse = ImpulseOf<Planar>;

/// Bound to one system, which must outlive it. State that a scheme keeps from one step to the next (an acceleration, a
/// step size) counts only when it is given the very q and v that it returned last; any other state restarts it.
template <class Space> class IntegratorOf {
 public:
  using System = SystemOf<Space>;
  using Impulse = ImpulseOf<Space>;

  /// Checks the system against what the scheme takes (capabilities.h).
  IntegratorOf(const System& system, std::string_view name, const Capabilities& can)
      : system_(system),
        gaps_(Eigen::VectorXd::Zero(system.contacts())),
        impulses_(static_cast<std::size_t>(system.contacts())),
        frictions_(system.scene().frictions.size()),
        name_(name),
        takes_pyramids_(can.pyramids) {
    check(system, name, can);
  }
  IntegratorOf(const IntegratorOf&) = delete;
  IntegratorOf& operator=(const IntegratorOf&) = delete;
  virtual ~IntegratorOf() = default;

  /// Advances `x` by h > 0 [s]. Unless the report says `solved`, a scheme of fixed step leaves x exactly as it was, one
  /// that controls its step leaves it at the last time it reached.
  virtual StepReport step(double h, Solver& solver, State& x) = 0;

  /// All that the scheme remembers from one step to the next, to `memory` or from it (checkpoint.h): a scheme that has
  /// read it goes on bit for bit as this one, which forgets what only saves it work (pivots chosen, matrices
  /// factorized).
  virtual void remember(CheckpointData& memory) = 0;

  /// Polled by schemes that divide their step; null: none. It must outlive the steps.
  void set_budget(const Budget* budget) { budget_ = budget; }
  const Budget* budget() const { return budget_; }

  /// The last complementarity problem, to dump and replay; of size 0 when there was none.
  virtual const Lcp& problem() const = 0;

  /// In words, why the last step did not end as `solved` ("no acceleration-level solution: …"); empty: the solver's
  /// status says it.
  virtual std::string why() const { return why_; }

  /// From now on large islands of a step (islands.h) are solved at the same time, by the solver that step() is given
  /// and these, one thread each. They should be solvers like that one: then every result is the same to the last bit,
  /// however many they are. For the schemes of fixed step; stages of impacts (impact.h) stay with the one solver.
  void employ(std::vector<std::unique_ptr<Solver>> helpers);

  /// Throws std::invalid_argument with option, value and rule where the solver has pyramids in place of friction discs
  /// (Solver::set_pyramids) and the scheme's own formulas hold the disc, or other edges.
  void check_pyramids(const Solver& solver) const;

  /// Whether the scheme divides the step that it is given: then the step bounds no penetration.
  virtual bool controls_step() const { return false; }
  /// Of searched collisions, behind the listed contacts: the pairs of gaps() and impulses(). Empty: none are
  /// searched.
  virtual std::span<const Pair> pairs() const { return {}; }

  const System& system() const { return system_; }
  const Eigen::VectorXd& gaps() const { return gaps_; }               // at the end of the last step [m]
  const std::vector<Impulse>& impulses() const { return impulses_; }  // of the last step, one per contact
  const std::vector<double>& frictions() const {
    return frictions_;
  }                                                          // likewise of dry friction in joints [N m s, N s]
  std::span<const Event> events() const { return events_; }  // located in the last step, in order of time

 protected:
  /// [m] A gap up to this is the rounding of positions that are `far` out [m]: bodies that touch would else come apart
  /// for a step repeatedly.
  static double touching(double far) { return 0x1p-48 * far; }

  /// True once the time is over or the caller has cancelled; the report says which.
  bool stopped(StepReport& report) const {
    if (budget_ == nullptr || !budget_->exhausted()) return false;
    report.status = budget_->cancelled() ? Status::cancelled : Status::time_limit;
    return true;
  }

  /// The step ends as `status`, why() has the words. Returns false.
  bool fail(StepReport& report, Status status, std::string why);

  /// Worker threads for islands; null: single-threaded.
  SolverPool* pool() const { return pool_.get(); }

  const System& system_;
  Eigen::VectorXd gaps_;
  std::vector<Impulse> impulses_;
  std::vector<double> frictions_;
  std::vector<Event> events_;
  std::string why_;

 private:
  std::string name_;
  bool takes_pyramids_;
  const Budget* budget_ = nullptr;
  std::unique_ptr<SolverPool> pool_;
};
extern template class IntegratorOf<Planar>;
extern template class IntegratorOf<Spatial>;
using Integrator = IntegratorOf<Planar>;

}  // namespace orthant
