// integrators/event_driven/spatial_event_driven.h — event-driven integration in space: smooth motion by a Runge–Kutta
// method of order 8 in charts of the rotations, impacts and changes of contact located and landed on.
//
//   Between events no contact changes its mode (spatial_motion.h). Every step (spatial_arc.h) ends with q and v
//   projected onto joints and lasting contacts. Watched are
//     open contact: g           → closing: cubics through gaps and rates at poses that turn by 1/4 rad at most, halved
//                                 where they come near zero
//     lasting ones: λ_N, μ λ_N − |λ_T| → opening, sliding off, by quartics through five values
//     sliding ones: |γ_T|       → no step is longer than 0.95 of the time that it would take to stop at its present
//                                 rate; it stops at atol
//   The first event is landed on by steps from the same start, their length by Newton's or secant steps. Then
//     a gap that closes at a velocity:  impact of all contacts that touch, by the scene's law, with discs of friction
//     after every event:                the modes by the problem at acceleration level (spatial_transition.h).
//   Contacts nearer than `touching`, and than the rounding of the steps and velocities since the last event, count as
//   touching, so that what is simultaneous stays so. Impacts that come at ever shorter intervals,
//   and no higher than `accumulation`, end in one without restitution (impact_series.h).
//   Impulses are refined to rounding (solvers/refinement.h), since the tolerance of a solver would affect the later
//   motion. Contacts whose forces are not unique (a box on four corners) share their load equally, in the sense of
//   least squares, where these forces push and stay within their cones: the solution that a solver finds depends on
//   rounding, and the moment of friction on the shares. Else they share it as the solver found.
//   Sliding off: the direction is that of the solution at acceleration level, until the slip is no longer stiff or
//   |γ_T| times the turn since reaches ten times rtol of the speeds and of what friction makes in a second.
//   Crowds: where events continue without end (several steps in a row without progress) or an instant has no computable
//   answer, steps of Moreau–Jean's method of `crossing` go across. Each is twice as long as the last one if no quiet
//   interval has followed since, up to 1e-4 s. Their error is of first order.
//   An acceleration-level problem that has no solution, or several, ends the run, see why().
//   Smooth error per step: rtol and atol of each body's place, velocity and angular velocity (lengths of vectors), and
//   of 1 rad of its orientation. No step is longer than a load or drive needs to swing by 3 rad, nor turns a body by
//   more than 1.5 rad.
//   Where a load jumps or bends (its breakpoints) a step ends, and the modes are decided again.
//   Limits: listed contacts only, no dry friction in joints. A graze shallower than the cubics' error (some 1e-7 of the
//   motion within a step) is overlooked. Series of impacts that several contacts have in turn end at one instant, one
//   after the other (impact.h).
//   Cost: 12 evaluations a step, 3 more where contacts last; each evaluates a lasting contact five times. Some 3 steps
//   an event.
//   Source: Pfeiffer & Glocker, Multibody Dynamics with Unilateral Contacts (1996); Brogliato & Acary (2008), ch. 8;
//   Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I (1993), II.4-6; see chart_runge_kutta.h.
#pragma once

#include <orthant/integrators/between_events/spatial_transition.h>
#include <orthant/integrators/event_driven/bounces.h>
#include <orthant/integrators/event_driven/event_driven.h>
#include <orthant/integrators/event_driven/spatial_arc.h>
#include <orthant/integrators/step/step_work.h>
#include <orthant/integrators/step/turn_watch.h>

namespace orthant {

class SpatialEventDriven final : public IntegratorOf<Spatial> {
 public:
  static constexpr std::string_view kName = EventDriven::kName;
  static constexpr Capabilities kCan = EventDriven::kCan;
  using Options = EventDrivenOptions;
  using Terms = TermsOf<Spatial>;

  explicit SpatialEventDriven(const System& system, const Options& options = {}, std::string_view name = kName);
  StepReport step(double h, Solver& solver, State& x) override;

  /// One inner step, of the length that its error allows and h at the most, with the event at its end: an arc, or a
  /// crossing. What was counted for crowds in the stride before counts on. False: it failed.
  bool stride(double h, Solver& solver, State& x, StepReport& report);
  const SpatialArc& arc() const { return arc_; }  // of the last stride

  void remember(CheckpointData& memory) override;
  const Lcp& problem() const override { return shown_ != nullptr ? shown_->problem() : transition_.problem(); }
  bool controls_step() const override { return kCan.error_control; }

 private:
  static constexpr double kTurnOfNode = 0.25;  // [rad] of a contact's rows between two looks at its gap
  static constexpr int kMostNodes = 64;        // looks at gaps in a step
  static constexpr double kStays = 256;        // roundings of a gap that does not change
  static double time_rounding(double t) { return 0x1p-49 * std::abs(t); }
  enum class Watch { gap, force, cone, stop };
  struct Sign {  // of an event
    Watch watch = Watch::gap;
    int contact = 0;
    double x = 1;     // of the step
    double deep = 1;  // likewise: a gap is smallest there, soon after x
  };
  struct Point {  // of the motion
    Eigen::VectorXd q, v, a;
    SpatialWatched w;
    SpatialMotion::Residual residual;
    Eigen::VectorXd force;      // [N, W], see SpatialFlow
    bool undetermined = false;  // by the share of loads
    explicit Point(const System& system);
  };
  struct Failure {
    Status status = Status::solved;
    std::string why;
  };
  struct DatedBounces : Bounces {
    double end = kInf;  // [s] of the series; later estimates that agree with it have more rounding
  };
  struct Crowd {                     // of events, and its crossing
    int steps = 0, standstill = 0;   // in a row that are short; since time moved
    int instants = 0;                // of this call at which something happened
    double length = 0, end = -kInf;  // [s] of the last crossing
  };
  struct Flight {  // since the last event
    int steps = 0;
    double time = 0;  // [s]
  };
  struct Node {  // gaps within a step
    double x = 0;
    Eigen::VectorXd gap, rate;
  };

  bool goes_on(const State& x) const;
  void restart(const State& x);
  void begin_call(const State& x);
  bool go(double h, Solver& solver, StepReport& report);
  void end_call(State& x, StepReport& report);

  bool give_up(Status status, std::string why);
  bool tells_turns();
  bool begin(Solver& solver, StepReport& report);
  bool advance(double h, Solver& solver, StepReport& report);
  double longest(double rest) const;
  double first_guess() const;
  /// whatever: trial_ is watched at any error: a part of an accepted step may exceed the tolerance by rounding.
  double attempt(double s, bool whatever = false);
  bool observe(Point& p, double t);
  bool turned() const;
  double left_out(std::size_t k) const;
  bool overdue() const;
  void end_departures();
  void accept(double s, bool at_stop, double stop);

  std::optional<Sign> first_sign(double s);  // without those dismissed
  bool stands_still(int contact);
  bool dismissed(Watch watch, int contact) const;
  void find_gaps(double s, std::optional<Sign>& first);
  std::optional<Sign> closing(int contact, double s, const Node& low, const Node& high, int depth);
  void between_ends(double s, double x, Eigen::VectorXd& q, Eigen::VectorXd& v);
  void find_ends(double s, std::optional<Sign>& first);
  double value(const Sign& sign, const Point& p) const;
  double slack(const Sign& sign) const;
  enum class Landing {
    there,  // the trial step ends at the event
    none,   // it is as long as before: the value is not negative near the sign
    fails   // likewise: no motion could be calculated on the way
  };
  Landing land(const Sign& sign, double& s);
  enum class Search { done, fails, endless };
  Search find_event(double& s, std::optional<Sign>& event);

  bool change(Solver& solver, const std::optional<Sign>& event, StepReport& report);
  bool change_or_cross(Solver& solver, const std::optional<Sign>& event, StepReport& report);
  bool reshare(Solver& solver, const Sign& event, StepReport& report);
  void close_together();
  bool impact(Solver& solver, bool plastic, StepReport& report);
  bool accumulates();
  bool settle(Solver& solver, const std::optional<Sign>& event, bool struck, StepReport& report);
  bool share_equally();
  bool shares_hold();
  bool goes_in(int contact);
  double acceleration_of(int contact);
  bool cross(Solver& solver, StepReport& report);
  void note_changes(bool touched);
  void emit(double t, EventKind kind, int contact, const Impulse& impulse = {});
  void sort_events();

  double gap_zero(int c) const { return 0x1p-52 * now_.w.gap_scale[c]; }
  bool stays(const Point& p, int c) const { return std::abs(p.w.gap[c]) <= kStays * gap_zero(c) + options_.touching; }
  /// An impact leaves the rounding of the rates before it.
  double rate_zero(int c) const { return options_.atol + 1e-12 * std::max(now_.w.rate_scale[c], struck_scale_[c]); }
  /// [m/s] slip below it is none: the error of some steps.
  double slip_zero(const Point& p) const {
    return options_.atol + 10 * (options_.rtol * p.v.lpNorm<Eigen::Infinity>() + motion_.slip_rounding(p.v));
  }
  double room(int contact, const Point& p) const;
  double low_gap(int c) const {
    return std::max({options_.accumulation, 256 * gap_zero(c), tie_[static_cast<std::size_t>(c)]});
  }

  Options options_;
  double swing_ = kInf;  // [s] the longest step
  bool measures_ = false;

  SpatialMotion motion_;
  SpatialTransition transition_;
  SpatialImmobility immobility_;
  FormulationOf<Spatial> formulation_;
  ImpactOf<Spatial> impact_;
  SpatialFlow flow_;
  MoreauJeanOf<Spatial> stepping_;            // of crossings
  std::optional<StepWorkOf<Spatial>> meter_;  // of crossings, where there is work to measure
  TurnWatch turns_;

  double time_ = 0;                     // [s] where the steps are
  double next_ = 0;                     // [s] length of the next step
  double end_ = kInf;                   // [s] of the call: no crossing goes on after it
  double stop_ = kInf;                  // [s] forces are not looked at later in this step
  bool begun_ = false, fresh_ = false;  // the modes are decided; now_ is observed
  bool no_answer_ = false;              // an instant has no answer that could be computed
  double load_ = 0;                     // [N] the largest normal force since the modes were decided
  double work_ = 0, effort_ = 0;        // [J] of this call; the sum of the parts' absolute values
  Point now_, trial_;
  std::vector<Sign> dismissed_;  // of the trial step: signs that are rounding
  SpatialArc arc_;
  State start_;                                                                    // of the trial step
  Eigen::VectorXd path_, path_rate_, path_bend_, path_scale_, v_scale_, hermite_;  // φ, φ', φ'' at the step's end
  State last_;                                                                     // what was returned
  Failure failed_;
  Crowd crowd_;
  Flight flight_;
  std::vector<double> tie_;  // [m] gaps that count as touching
  std::vector<DatedBounces> bounces_;
  std::vector<char> touching_, released_, in_turn_;
  std::vector<Vector3d> slides_;  // contacts that slide off, along this
  std::vector<SpatialMode> before_;
  std::vector<RateTargetOf<Spatial>> targets_;
  std::vector<Impulse> struck_;
  std::vector<int> contacts_;
  Eigen::VectorXd fall_;          // [m/s²] accelerations of gaps
  Eigen::VectorXd struck_scale_;  // [m/s] rate scales before the impact at now_; 0: there was none
  Eigen::VectorXd v_before_, none_, q_within_, v_within_;
  State crossed_;
  const FormulationOf<Spatial>* shown_;  // by problem(); null: the transition
};

}  // namespace orthant
