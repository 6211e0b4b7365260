// integrators/adaptive/adaptive.h — adaptive integration: event location and dense output to a tolerance, at any
// output step.
//
//   Inner steps are those of event_driven.h: a Runge–Kutta method of order 8 while no contact changes its mode; impacts
//   and changes of mode are located and landed on, and series of impacts are summed to their limit. They do not depend
//   on the requested times: they continue past the end of a call, and the states between them come from a polynomial
//   (arc_interpolant.h). Neither the motion nor its cost depends on the output step or on the end of the run. If an
//   inner step fails past the end of a call, the call that reaches this time reports it.
//   Tolerance: an inner step is held to a thousandth of rtol and atol, 1e-13 and 1e-14 at the least (rounding). A gap
//   below this thousandth of atol counts as closed at an impact of another contact, but not where both have just been
//   struck: a body crushed between others strikes them in turn within picoseconds. The motion may magnify errors by
//   more than the thousand: this is not controlled. error_estimate of a run is the sum of the errors of the inner
//   steps; `--check` of the command measures the final error.
//   Measured on the slider-crank: |Δθ₁| after 3 turns is 0.001 to 0.05 of rtol from 1e-3 to 1e-9 (e ≤ 0.4).
//   Where events crowd, and at instants without an answer or with several (Painlevé's paradox, impacts whose friction
//   and restitution contradict each other, redundant joints at a singular pose), steps of Moreau–Jean's method of 1e-6
//   s and more go across, to first order: they are counted as crossings, and error_estimate has their share.
//   No inner step is longer than the larger of ten times the one before and the time run so far, nor than a load or
//   drive needs to swing by 3 rad.
//   Events and impulses belong to the call that contains their time, those of a crossing to the call that contains its
//   end.
//   Cost: some 13 evaluations an inner step, some 3 steps an event; about 30 operations per coordinate an
//   output, and a projection where there are joints or lasting contacts. Outputs within a crossing are not projected.
// Source: Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I (1993), II.6 (dense output); see also
// event_driven.h and arc_interpolant.h.
#pragma once

#include <orthant/integrators/between_events/arc_interpolant.h>
#include <orthant/integrators/event_driven/event_driven.h>
#include <orthant/integrators/step/work_meter.h>

#include <optional>

namespace orthant {

struct AdaptiveOptions {
  double rtol = 1e-6, atol = 1e-9;  // of q and v, entry by entry: rtol |y| + atol
  int max_steps = 1000000;          // inner steps and rejected ones of one call
  template <class V> void visit(V&& v) {
    v("rtol", rtol, 0.0, 1.0), v("atol", atol, 1e-15, 1.0), v("max_steps", max_steps, 1, 2000000000);
  }
};

class Adaptive final : public Integrator {
 public:
  static constexpr std::string_view kName = "adaptive";
  static constexpr Capabilities kCan{
      .loaded_friction = false, .error_control = true, .threads = false, .pyramids = false};
  using Options = AdaptiveOptions;
  explicit Adaptive(const System& system, const Options& options = {});
  StepReport step(double h, Solver& solver, State& x) override;
  void remember(CheckpointData& memory) override;
  const Lcp& problem() const override { return engine_.problem(); }
  bool controls_step() const override { return kCan.error_control; }

 private:
  bool goes_on(const State& x) const;
  void restart(const State& x);
  bool stride(Solver& solver, StepReport& report);
  void finish_stride(StepReport& report);
  void hand_over_until(double t);
  void measure_work(const State& to, StepReport& report);
  ContactMotion::Residual interpolate(double t, State& x);
  void hand_over_rises(double t, StepReport& report);
  void hand_out(double end, State& x, StepReport& report);

  /// Where the inner steps are.
  struct InnerEnd {
    State state;
    Eigen::VectorXd gaps;              // [m]
    ContactMotion::Residual residual;  // of the joints
    Status status = Status::solved;    // of the inner step that ended there
    std::string why;
  };
  /// Of the last inner step, not handed out yet.
  struct Left {
    std::vector<Event> events;
    std::vector<Impulse> impulses;  // [N s]
    std::vector<Impulse> smooth;    // [N s] of its arc, handed out already
    double work = 0;                // [J]
    State measured;                 // up to which that of the arc is handed out
    int rises = 0;                  // of energy; the largest [J], and its time [s]
    double rise = 0, rise_time = kInf;
    double effort = 0, least_weight = kInf;  // [J]
  };
  /// Lengths of inner steps. [s]
  struct Strides {
    double longest = kInf;  // by the swing of loads and drives
    double began = 0;       // start of the run
    double reach = 0;       // of the next one, by those before
  };

  Options options_;
  EventDriven engine_;
  State before_;  // the last inner step
  InnerEnd end_;
  Left left_;
  Strides stride_;
  State last_;  // what was returned
  ArcInterpolant between_;
  bool fitted_ = false;                  // between_ is that of the engine's last arc
  std::optional<ContactMotion> joints_;  // without contacts, for states within a crossing; where there are joints
  State part_;                           // of the arc, whose work is measured
  State on_joints_;
  Terms terms_;
  std::optional<WorkMeter> meter_;  // where there is work to measure
};

}  // namespace orthant
