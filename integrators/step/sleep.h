// integrators/step/sleep.h — sleep: islands at rest are not stepped until a contact, a load or a changed state wakes
// them.
//
//   An island (islands.h) falls asleep when all its bodies have moved no faster than `speed` for `after` seconds: its
//   velocities become 0, its rows leave the step's problem, its contact forces stay what they were. It wakes, as a
//   whole and within the step, when
//     an awake body's contact with it closes,
//     a load, spring or weight on one of its bodies is no longer what it was (to 1e-9),
//     the state given is not the one returned last.
//   Contacts with a moving surface and driven joints keep it awake. Off by default (after = 0).
// Error: the dropped velocities, at most `speed`, and the motion by them. A load that is there from the start and moves
// a body slower than `speed` for `after` seconds lets it sleep permanently. So `speed` should be above the
// solver's residual and `after` longer than a turning point takes: 2 speed / g.
// Schemes that let stacks tremble by g h (stewart-trinkle and its kin: what lies on a falling body is not yet closed)
// keep them awake.
// Cost: O(bodies + closed contacts) a step; a sleeping island costs its gaps and forces only.
#pragma once

#include <orthant/integrators/step/formulate.h>
#include <orthant/integrators/step/islands.h>

namespace orthant {

struct SleepOptions {
  double after = 0;     // [s]; 0: never
  double speed = 1e-6;  // [m/s, rad/s]
};

template <class Space> class SleepOf {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;
  using Impulse = ImpulseOf<Space>;

  SleepOf(const System& system, const SleepOptions& options);

  /// Before contacts are closed: wakes whom the state or the forces terms.f wake; the others' v_free becomes 0.
  void begin(const State& x, const Terms& terms, Eigen::VectorXd& v_free);

  /// Contacts are closed: true, they woke some (whose v_free is back): close them again. False: those of the sleeping
  /// are taken out.
  bool disturbed(Terms& terms, std::vector<RateTargetOf<Space>>& targets, Eigen::VectorXd& v_free);

  /// The forces of the sleeping contacts, as impulses of the step.
  void hold(double h, std::vector<Impulse>& impulses) const;

  /// The step is done: who falls asleep.
  void end(double h, const Terms& terms, const std::vector<Impulse>& impulses, State& x);

  void remember(CheckpointData& memory) {
    memory(island_, islands_so_far_, rest_, force_, pairs_, f_, last_q_, last_v_);
  }

  int sleeping() const;  // bodies

 private:
  bool on() const { return options_.after > 0; }
  bool asleep(BodyId body) const { return body >= 0 && island_[static_cast<std::size_t>(body)] > 0; }
  bool sleeps(std::size_t contact) const;
  void wake(int island);

  SleepOptions options_;
  const System& system_;
  Islands islands_;
  std::vector<int> island_;  // that each body sleeps in; 0: awake
  int islands_so_far_ = 0;
  std::vector<double> rest_;  // [s] that each body has been slow
  std::vector<double> least_;
  std::vector<RowOf<Space>> rows_;
  std::vector<Impulse> force_;  // of contacts that sleep [N]
  std::vector<Impulse> scratch_;
  std::vector<Pair> pairs_;  // of the last step
  Eigen::VectorXd f_, v_free_, last_q_, last_v_;
};
extern template class SleepOf<Planar>;
extern template class SleepOf<Spatial>;

}  // namespace orthant
