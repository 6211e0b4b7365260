// integrators/adaptive/spatial_adaptive.h — adaptive in space: event location to a tolerance, at any output step.
//
//   Inner steps are those of spatial_event_driven.h: a Runge–Kutta method of order 8 in charts of the rotations while
//   no contact changes its mode; impacts and changes of mode are located and landed on. Impacts that come at ever
//   shorter intervals, no higher than ten times atol of an inner step and 5 m times rtol², end in one without
//   restitution.
//   The requested states do not affect the inner steps: they, impulses and work come from the continuous extension of
//   the method, of order 7, and are projected. Neither the motion nor its cost depends on the output step or on the end
//   of the run.
//   Tolerance: an inner step is held to a thousandth of rtol and atol, 1e-13 and 1e-14 at the least, of each body's
//   place, velocity and angular velocity (lengths of vectors), and of 1 rad of its orientation. The motion may magnify
//   errors by more than the thousand: this is not controlled. error_estimate of a run is the sum of the errors of the
//   inner steps; `--check` of the command measures the final error.
//   Where events crowd, and at instants without an answer or with several, steps of Moreau–Jean's method of 1e-6 s and
//   more go across, to first order: they are counted as crossings, and error_estimate has their share.
//   No inner step is longer than the larger of ten times the one before and the time run so far.
//   Limits: those of spatial_event_driven.h.
//   Cost: 12 evaluations an inner step, 3 more where contacts last, 16 more where states within it are called for; each
//   evaluates a lasting contact five times. Some 3 steps an event.
// Source: see chart_runge_kutta.h, event_driven.h; Pfeiffer & Glocker (1996); Brogliato & Acary (2008), ch. 8.
#pragma once

#include <orthant/integrators/adaptive/adaptive.h>
#include <orthant/integrators/event_driven/spatial_event_driven.h>

namespace orthant {

class SpatialAdaptive final : public IntegratorOf<Spatial> {
 public:
  static constexpr std::string_view kName = Adaptive::kName;
  static constexpr Capabilities kCan = Adaptive::kCan;
  using Options = AdaptiveOptions;
  using Terms = TermsOf<Spatial>;

  explicit SpatialAdaptive(const System& system, const Options& options = {});
  StepReport step(double h, Solver& solver, State& x) override;
  void remember(CheckpointData& memory) override;
  const Lcp& problem() const override { return engine_.problem(); }
  bool controls_step() const override { return kCan.error_control; }

 private:
  struct Left {  // what is still to be handed out of the last inner step
    std::vector<Event> events;
    std::vector<Impulse> impulses;
    double work = 0;       // [J]
    int undetermined = 0;  // steps, see StepReport
  };
  struct Failure {  // of the inner step that ended at inner_
    Status status = Status::solved;
    std::string why;
  };

  bool goes_on(const State& x) const;
  void restart(const State& x);
  void stride(Solver& solver, StepReport& report);
  void hand_over_all(StepReport& report);
  void hand_out(double target, State& x, StepReport& report);
  void within_crossing(double t, State& x);
  void hand_out_within(double t, State& x, StepReport& report);
  bool fit();

  Options options_;
  SpatialEventDriven engine_;
  SpatialMotion between_;  // of states within inner steps
  SpatialFlow flow_;       // likewise
  bool measures_ = false;
  State inner_, before_, last_;   // where the inner steps are; where the last one began; what was returned
  double began_ = 0, reach_ = 0;  // [s] start of the run; longest next inner step
  bool fitted_ = false;           // flow_ is of the last arc
  double joint_residual_ = 0, joint_rate_ = 0;  // at inner_
  Eigen::VectorXd push_, handed_push_;          // [N s, J] of lasting contacts; handed out of the last arc
  Left left_;
  Failure failed_;
  Eigen::VectorXd q_within_, v_within_;
  Terms handed_;  // for gaps of states handed out
};

}  // namespace orthant
