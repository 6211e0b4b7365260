// integrators/adaptive/spatial_adaptive.h — adaptive in space: event location to a tolerance, at any output step.
//
//   Inner steps: a Runge–Kutta method of order 8 in charts of the rotations (chart_runge_kutta.h) while no contact
//   changes its mode (spatial_motion.h). Each ends with q and v projected onto joints and lasting contacts. Watched are
//     open contact: g           → closing: cubics through gaps and rates at poses that turn by 1/4 rad at most, halved
//                                 where they come near zero
//     lasting ones: λ_N, μ λ_N − |λ_T| → opening, sliding off, by quartics through five values
//     sliding ones: |γ_T|       → no step is longer than 0.95 of the time that it would take to stop at its present
//                                 rate; it stops at atol
//   The first event is landed on by steps from the same start, their length by Newton's or secant steps. Then
//     a gap that closes at a velocity:  impact of all contacts that touch, by the scene's law, with discs of friction
//     after every event:                the modes by the problem at acceleration level (spatial_transition.h).
//   Impacts that come at ever shorter intervals, and no higher than ten times atol of an inner step, end in one without
//   restitution (impact_series.h).
//   The states that are called for do not shape the inner steps: they, impulses and work come from the continuous
//   extension of the method, of order 7, and are projected. Neither the motion nor its cost depends on the output step
//   or on the end of the run.
//   Tolerance: an inner step is held to a thousandth of rtol and atol, 1e-13 and 1e-14 at the least, of each body's
//   place, velocity and angular velocity (lengths of vectors), and of 1 rad of its orientation. The motion may magnify
//   errors by more than the thousand: this is not controlled. error_estimate of a run is the sum of the errors of the
//   inner steps; `--check` of the command measures the final error.
//   Where events crowd, and at instants without an answer, steps of Moreau–Jean's method of 1e-6 s and more go across,
//   to first order: they are counted as crossings, and error_estimate has their share.
//   No inner step is longer than the larger of ten times the one before and the time run so far, nor than a load or
//   drive needs to swing by 3 rad, nor turns a body by more than 1.5 rad.
//   Limits: listed contacts only, no dry friction in joints. Of several solutions at acceleration level (Painlevé) the
//   solver's is taken. A graze shallower than the cubics' error (some 1e-7 of the motion within a step) is overlooked.
//   Series of impacts that several contacts have in turn end at one instant, one after the other (impact.h).
//   Cost: 12 evaluations an inner step, 3 more where contacts last, 16 more where states within it are called for; each
//   evaluates a lasting contact five times. Some 3 steps an event.
// Source: see chart_runge_kutta.h, event_driven.h; Pfeiffer & Glocker (1996); Brogliato & Acary (2008), ch. 8.
#pragma once

#include <orthant/integrators/adaptive/adaptive.h>
#include <orthant/integrators/adaptive/chart_runge_kutta.h>
#include <orthant/integrators/between_events/impact_series.h>
#include <orthant/integrators/between_events/spatial_transition.h>

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
  const Lcp& problem() const override { return shown_ != nullptr ? shown_->problem() : transition_.problem(); }
  bool controls_step() const override { return kCan.error_control; }

 private:
  enum class Watch { gap, force, cone, stop };
  struct Sign {  // of an event
    Watch watch = Watch::gap;
    int contact = 0;
    double x = 1;  // of the step
  };
  struct Point {  // of the motion
    Eigen::VectorXd q, v, a;
    SpatialWatched w;
    SpatialMotion::Residual residual;
    Eigen::VectorXd force;  // [N] three a contact, and the power [W]
    explicit Point(const System& system);
  };
  struct Tolerance {  // of an inner step
    double rtol = 0, atol = 0;
  };
  struct Stride {  // the last inner step: an arc of smooth motion, or a crossing
    State start;
    Eigen::VectorXd a;               // at its start
    Eigen::VectorXd force;           // [N, W] likewise
    std::vector<SpatialMode> modes;  // on the arc
    double length = 0;               // [s]
    bool arc = false;
    bool fitted = false;   // extension_ and that of the method are of it
    Eigen::VectorXd push;  // [N s, J] of lasting contacts so far, handed out
  };
  struct Left {  // what is still to be handed out of the last inner step
    std::vector<Event> events;
    std::vector<Impulse> impulses;
    double work = 0;  // [J]
  };
  struct Failure {  // of the inner step that ended at time_
    Status status = Status::solved;
    std::string why;
  };
  struct Bounces : ImpactSeries {  // a contact's impacts
    double height = 0;             // [m] bound of the next bounce
    bool rounding = false;         // the last bounce was of the size of rounding
    bool over = false;             // accumulated, just now
  };
  struct Crowd {  // of events, and its crossing
    int steps = 0, standstill = 0;
    double length = 0, end = -kInf;  // [s] of the last crossing
  };
  struct Node {  // gaps within a step
    double x = 0;
    Eigen::VectorXd gap, rate;
  };

  bool goes_on(const State& x) const;
  void restart(const State& x);
  bool stride(Solver& solver, StepReport& report);
  void hand_over_all(StepReport& report);
  void hand_out(double target, State& x, StepReport& report);
  void hand_out_within(double t, State& x, StepReport& report);
  bool fit();
  void note_stage(const SpatialMotion& motion, std::size_t stage);

  bool give_up(Status status, std::string why);
  bool begin(Solver& solver, StepReport& report);
  bool advance(Solver& solver, StepReport& report);
  double longest(double rest) const;
  double first_guess() const;
  template <class Motion> auto acceleration_in(Motion& motion);
  bool integrate(SpatialMotion& motion, double t, const State& from, const Eigen::VectorXd& a, double s,
                 Eigen::VectorXd& q, Eigen::VectorXd& v);
  double attempt(double s);
  bool observe(Point& p, double t);
  bool turned() const;
  double left_out(std::size_t k) const;
  bool overdue() const;
  void end_departures();
  void accept(double s, bool at_stop, double stop);

  std::optional<Sign> first_sign(double s);
  void find_gaps(double s, std::optional<Sign>& first);
  std::optional<double> closing(int contact, double s, const Node& low, const Node& high, int depth);
  void between_ends(double s, double x, Eigen::VectorXd& q, Eigen::VectorXd& v);
  void find_ends(double s, std::optional<Sign>& first);
  double value(const Sign& sign, const Point& p) const;
  double slack(const Sign& sign) const;
  bool land(const Sign& sign, double& s);

  bool change(Solver& solver, const std::optional<Sign>& event, StepReport& report);
  bool reshare(Solver& solver, const Sign& event, StepReport& report);
  bool impact(Solver& solver, bool plastic, StepReport& report);
  bool waits(const Bounces& ending) const;
  bool meets_in_turn(int contact) const;
  bool accumulates();
  bool ends_in_turn();
  bool settle(Solver& solver, const std::optional<Sign>& event, bool struck, StepReport& report);
  bool cross(Solver& solver, StepReport& report);
  void note_changes(bool touched);
  void emit(double t, EventKind kind, int contact, const Impulse& impulse = {});

  double gap_zero(int c) const { return 0x1p-52 * now_.w.gap_scale[c]; }
  double rate_zero(int c) const { return inner_.atol + 1e-12 * now_.w.rate_scale[c]; }
  double slip_zero(const Point& p) const { return inner_.atol + 10 * motion_.slip_rounding(p.v); }
  double room(int contact, const Point& p) const;
  double low_gap(int c) const { return std::max(10 * inner_.atol, 256 * gap_zero(c)); }
  /// When the contact struck last before now [s].
  double before_now(const Bounces& b) const { return b.last == time_ ? b.last - b.interval : b.last; }

  Options options_;
  Tolerance inner_;
  double swing_ = kInf;  // [s] the longest inner step
  bool measures_ = false;

  SpatialMotion motion_, between_;  // of inner steps; of states within them
  SpatialTransition transition_;
  FormulationOf<Spatial> formulation_;
  ImpactOf<Spatial> impact_;
  ChartRungeKutta rk_;
  MoreauJeanOf<Spatial> stepping_;  // of crossings

  double time_ = 0;                          // [s] where the inner steps are
  double began_ = 0, reach_ = 0, next_ = 0;  // [s] start of the run; longest next inner step, and its length
  double stop_ = kInf;                       // [s] forces are not looked at later in this step
  bool begun_ = false, fresh_ = false;       // the modes are decided; now_ is observed
  double load_ = 0;                          // [N] the largest normal force since the modes were decided
  Point now_, trial_;
  Eigen::VectorXd path_, path_rate_, path_bend_, path_scale_, v_scale_, hermite_;  // φ, φ', φ'' at the step's end
  Eigen::MatrixXd stage_force_;                 // [N, W] of each stage, less those at the start
  Eigen::VectorXd push_;                        // [N s, J] of the trial step
  ContinuousExtension extension_;               // of the impulses and the work
  double stage_power_ = 0;                      // [W]
  const Eigen::VectorXd* now_force_ = nullptr;  // [N, W] at the start of the step that is integrated
  Stride stride_;
  Left left_;
  Failure failed_;
  State last_;  // what was returned
  Crowd crowd_;
  std::vector<Bounces> bounces_;
  std::vector<char> touching_, released_, in_turn_;
  std::vector<Vector3d> slides_;  // contacts that slide off, along this
  std::vector<SpatialMode> before_;
  std::vector<RateTargetOf<Spatial>> wanted_;
  std::vector<Impulse> struck_;
  std::vector<int> contacts_;
  Eigen::VectorXd v_before_, none_, q_within_, v_within_;
  State crossed_;
  Terms handed_;                         // for gaps of states handed out
  const FormulationOf<Spatial>* shown_;  // by problem(); null: the transition
};

}  // namespace orthant
