// integrators/event_driven/event_driven.h — event-driven integration: the smooth motion by a Runge–Kutta method of
// order 8; impacts and changes of contact located.
//
//   Between events the contacts' modes are fixed (contact_motion.h) and q' = v, v' = a(t, q, v) is integrated with
//   error control (dormand_prince.h); every step ends with q and v projected onto joints and lasting contacts. Watched
//   are
//     open contact: g           → closing, on the whole way that the step goes, however long (continuous_collision.h)
//     lasting ones: forces, slip → opening, sliding off, stopping (contact_watch.h).
//   The first one to turn negative is landed on by steps from the same start, their length by secant steps: nothing is
//   interpolated, so that the state there has the full order. Then
//     a gap that closes at a velocity:  impact of all contacts that touch, Newton's e, e_t and Coulomb friction, at
//     velocity
//                                       level (formulate.h, reduced form)
//     after every event:                the modes by the problem at acceleration level (contact_transition.h).
//   Contacts nearer than `touching` (and than 1e-9 of the way since they struck), and than the rounding of the steps
//   and velocities since the last event, count as touching, so that what is simultaneous stays so. Where contacts last
//   no step is longer than look_ahead.h allows.
//   Accumulation: when a contact's impacts come at ever shorter intervals (two in a row, each < 0.999 of the one
//   before), forces bring it back between them, and the next bounce would be no higher than `accumulation` (nor than
//   rounding of the gap), one impact without restitution takes the place of all that follow, for all contacts in this
//   state, and they last; but not where another contact strikes before the last of them. The event has the time
//   extrapolated from the geometric series, T later. Error made: gaps up to `accumulation` are taken as zero, and the
//   impulses that remain (γ_N times mass) come up to T early: in coordinates of the order of γ_N T, some 10 times
//   `accumulation`. Series that several contacts have in turn end together, when all are that low, or where two of them
//   touch at once; their remaining impacts, which may still be large, follow one after the other at that instant
//   (impact.h).
//   Contacts that bear a load together share it in proportion to what each can bear; one at the bound of its friction
//   stays there while others hold it.
//   Crowds: where events continue without end (several steps in a row without progress: chatter, hyperstatic friction)
//   or an instant has no computable answer, a step of Moreau-Jean's method of `crossing` goes across. It is twice the
//   last one if no quiet interval has followed since, up to 1e-4 s, but no longer than bodies need to pass each other.
//   A contact that separates no faster than bodies fall within this step lasts. The error is of first order: speeds
//   times the length of the step. Runs without crowds have none.
//   Smooth error per step: rtol |y_i| + atol, y = (q, v), or what rounding of the coordinates makes of the
//   accelerations. The work of drives and moving surfaces: 1e3 rtol of its sum (stage_quadrature.h). An event's time
//   is found to rounding of the event function.
//   Next to singular poses of the joints (dependent rows) velocities are known to ε/δ² only and accelerations to ε/δ³,
//   δ the distance: such poses are passed over in one step, no stage of which is very near. A state requested there is
//   returned, but the next step starts where the last one did (with lasting contacts: from the requested state).
//   Where a lasting contact's normal jumps (a corner comes to the end of its face, and lies against an edge from then
//   on) a step ends, too, as near to it as times can be distinguished; its velocity is no more along the contact then:
//   it strikes, or leaves. Likewise where its force jumps across zero: a disc rolls off a flat face onto the corner.
//   Where a load jumps or bends (its breakpoints) a step ends, and the modes are decided again.
//   A start with overlap: such a contact acts only while it does not separate. The approach after a separation is an
//   event, and so is the gap 0 (overlap.cpp).
//   Limits: a graze shallower than the polynomials' error (some 1e-9 of the motion within a step) is overlooked. An
//   impact or an acceleration-level problem without solution, or one with several, ends the run, see why(). In crowds
//   the result depends on rounding: piles come to rest, but not always in the same places. Every contact's row is
//   evaluated in every step. Cost: 13 evaluations a step, some 3 steps an event.
//   Source: Pfeiffer & Glocker, Multibody Dynamics with Unilateral Contacts (1996); Brogliato & Acary (2008), ch. 8;
//   Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I (1993), II.4-6.
#pragma once

#include <orthant/integrators/between_events/arc_interpolant.h>
#include <orthant/integrators/between_events/contact_transition.h>
#include <orthant/integrators/between_events/contact_watch.h>
#include <orthant/integrators/between_events/continuous_collision.h>
#include <orthant/integrators/between_events/listed_contacts.h>
#include <orthant/integrators/event_driven/bounces.h>
#include <orthant/integrators/event_driven/stage_quadrature.h>
#include <orthant/integrators/fixed_step/moreau_jean.h>
#include <orthant/integrators/step/immobility.h>
#include <orthant/integrators/step/impact.h>
#include <orthant/integrators/step/jam.h>
#include <orthant/integrators/step/pulley_watch.h>
#include <orthant/integrators/step/work_meter.h>

namespace orthant {

inline constexpr double kRounding = 0x1p-52;

inline constexpr std::string_view kSingularPose = "redundant joints next to a singular pose";

struct EventDrivenOptions {  // lengths and speeds count times System::length_unit()
  double rtol = 1e-13,
         atol = 1e-14;          // error of a step, per entry of q and v; atol is also the slip [m/s] taken as none
  double first_step = 0;        // [s]; 0: from the accelerations
  double touching = 1e-15;      // [m] gap taken as closed where another contact is struck
  double accumulation = 1e-14;  // [m] height of bounces that are not resolved any more
  double crossing = 1e-6;       // [s] first step of Moreau–Jean's method where events have no end or no answer
  int max_events = 1000000;     // instants of one call of step() at which contacts strike or change their modes
  bool go_on = false;           // not listed: an instant that has no answer, or several, is crossed as a crowd is
  template <class V> void visit(V&& v) {
    v("rtol", rtol, 1e-15, 1e-2), v("atol", atol, 1e-30, 1e-2), v("first_step", first_step, 0.0, 1e6);
    v("touching", touching, 0.0, 1e-3), v("accumulation", accumulation, 0.0, 1e-3);
    v("crossing", crossing, 1e-9, 1e-4), v("max_events", max_events, 1, 1000000000);
  }
};

class EventDriven final : public Integrator {
 public:
  static constexpr std::string_view kName = "event-driven";
  static constexpr Capabilities kCan{
      .loaded_friction = false, .error_control = true, .threads = false, .pyramids = false};
  using Options = EventDrivenOptions;
  explicit EventDriven(const System& system, const Options& options = {}, std::string_view name = kName);
  StepReport step(double h, Solver& solver, State& x) override { return go(h, false, solver, x); }

  /// One inner step, of the length that its error allows and h at the most, with the event at its end: an arc, then
  /// maybe one step of a crossing. What was counted for crowds in the stride before counts on.
  StepReport stride(double h, Solver& solver, State& x) { return go(h, true, solver, x); }
  const Arc& arc() const { return arc_; }  // of the last stride

  void remember(CheckpointData& memory) override;
  const Lcp& problem() const override { return shown_ != nullptr ? shown_->problem() : transition_.problem(); }
  bool controls_step() const override { return kCan.error_control; }

 private:
  static constexpr double kStays = 1e3;     // roundings of a gap that only joints move
  static constexpr double kOverlap = 1e6;   // roundings of a gap: deeper is no rounding
  static constexpr double kInstant = 8;     // roundings of the time: the shortest crossing
  static constexpr double kCrowded = 1e-4;  // of a crossing: events are taken to have no end
  static constexpr double kSoon = 50;       // crossings: no calm has come since the last one
  struct Point : MotionPoint {
    double independence = 1;  // of the joint rows
    double power = 0;         // [W] of drives, loads and moving surfaces, where it is measured
    using MotionPoint::MotionPoint;
    void remember(CheckpointData& memory) {
      MotionPoint::remember(memory);
      memory(independence, power);
    }
  };

  struct Lead {       // the state that was handed out before now_, which goes on from behind it
    double time = 0;  // [s]
    double work = 0;  // [J]
  };
  struct JointRank {                // rank of the joints' rows
    int rank = 0;                   // away from singular poses
    double least_independence = 1;  // in the trial step, of the rows in their order
  };
  struct Flight {  // since the last event
    int steps = 0;
    double time = 0;  // [s]
  };
  struct Crowd {         // of events
    int standstill = 0;  // steps since time moved
    int steps = 0;       // since it moved by more than next to nothing
    int shared = 0;      // times that friction was shared again meanwhile
    int instants = 0;    // of this call at which something happened
  };
  struct CrowdCrossing {             // of a crowd, by steps of Moreau–Jean's method
    State state;                     // of its step
    double step = 0, end = -kInf;    // [s] the last of its steps, and its end
    bool goes_on = false;            // the stride before ended within a crossing, which goes on
    Status status = Status::solved;  // why it began
    std::string why;
    bool smooth = false;  // of a singular pose: it keeps the energy
    void remember(CheckpointData& memory) { memory(step, end, goes_on, status, why, smooth); }
  };
  struct Scale {            // of the error of a step
    Eigen::VectorXd q, v;   // allowed
    Eigen::VectorXd noise;  // of the accelerations [m/s², rad/s²]
  };
  struct Strike {                   // an impact
    std::vector<char> touching;     // contacts that take part
    std::vector<char> in_turn;      // struck one after the other, without restitution
    std::vector<double> tie;        // [m] gaps that count as touching
    std::vector<int> contacts;      // that are closed
    std::vector<Impulse> impulses;  // [N s]
    Eigen::VectorXd v_before;
    explicit Strike(std::size_t contacts_of_scene)
        : touching(contacts_of_scene), in_turn(touching), tie(contacts_of_scene), impulses(contacts_of_scene) {}
  };
  struct Freed {                 // contacts that end what they did
    std::vector<char> turned;    // stand for another normal
    std::vector<char> released;  // open
    std::vector<double> slides;  // ±1: slide off
    std::vector<char> held;      // slide at the bound while others hold them
    explicit Freed(std::size_t contacts) : turned(contacts), released(turned), slides(contacts), held(turned) {}
  };
  struct Stage {  // coordinates and velocities to be projected, for a look
    Eigen::VectorXd q, v;
  };

  StepReport go(double h, bool one, Solver& solver, State& x);
  void sort_events();
  bool begin(Solver& solver, const State& x, StepReport& report);
  bool fail_apart(double residual, StepReport& report);  // joints are left so far apart [m, rad]
  bool keeps_directions(StepReport& report);
  double next_stop() const;
  bool renew(Solver& solver, StepReport& report);
  bool advance(Solver& solver, double end, bool last, StepReport& report);
  double error_of_step(double s);
  void flow_at(const Point& p);
  template <class To> void add_flow(double power, To& to) const;
  std::optional<double> pose_in(double s) const;
  void measure_noise();
  bool pass_over(double& s, double rest);
  bool hand_out(double s);
  double first_guess(double rest) const;
  double shortest_step() const { return 1e-3 * kRounding * (std::abs(start_) + elapsed_) + 1e-30; }  // [s]
  double independence() const;
  bool observe(Point& p, double t);
  bool try_step(double s);
  bool turned(std::size_t lasting, double s) const;
  bool turns(double s) const;
  bool find_turn(double& s);
  bool find_jump(const Sign& sign, double& s);
  double jump_of_force() const;
  bool last_stage_behind() const;
  bool end_behind(double low, double high, double& s);
  void accept(double s, double end);
  void add_work(double work) { work_ += work, effort_ += std::abs(work); }
  void note_arc(double before);
  void note_lead();
  bool turn(Solver& solver, double s, double end, StepReport& report);

  bool immobile(int contact);
  bool turns_back(int contact);
  bool stands(int contact, double s) const;
  double value(const Sign& sign, const Watched& w) const;
  double slack(const Sign& sign) const;
  std::optional<Sign> first_sign(double s);
  bool overlaps(int contact) const { return now_.w.gap[contact] < -(kOverlap * gap_zero(contact) + options_.touching); }
  std::optional<Sign> end_of_overlap(int contact, double s);
  bool land(const Sign& sign, double& s);

  bool change_modes(Solver& solver, const std::optional<Sign>& event, StepReport& report);
  bool impact(Solver& solver, bool plastic, StepReport& report);
  bool cross(Solver& solver, double end, StepReport& report);
  bool leaves_room(const State& x);
  bool keep_energy(const State& before, double work);
  void close_together();
  void note_bounce(int contact);
  bool accumulates();
  bool strikes_after_series();
  bool settle(Solver& solver, const std::optional<Sign>& event, bool struck, StepReport& report);
  bool come_to_rest();
  bool shares_anew(const Sign& event);
  bool leaves_cones() const;
  double force_zero() const;
  double room(int contact) const;
  void let_go(const Sign& event);
  void gather_candidates();
  void note_changes(bool touched);
  double gap_zero(int contact) const { return kRounding * now_.w.gap_scale[contact]; }  // [m]
  bool stays(double gap, int contact) const { return std::abs(gap) <= kStays * gap_zero(contact) + options_.touching; }
  double speed_zero(double scale) const { return options_.atol + kSame * scale; }

  Options options_;       // with lengths and speeds times length_unit()
  Eigen::VectorXd atol_;  // dof
  ContactMotion motion_;
  ContactWatch watch_;
  ContinuousCollision sweep_;
  ContactTransition transition_;
  Formulation formulation_;
  Impact impact_;
  Immobility immobility_;
  DormandPrince rk_;
  MoreauJean stepping_;                    // of crossings
  std::optional<WorkMeter> meter_;         // where there is work to measure
  std::optional<PulleyWatch> pulleys_;     // where ropes lead over some
  std::unique_ptr<JamSearch> jam_search_;  // of crossings, where drives may press contacts

  Point now_, trial_, middle_, earlier_;
  ContactMotion::Residual residual_, trial_residual_;
  Arc arc_;
  bool striding_ = false;
  double start_ = 0, elapsed_ = 0, h_ = 0;  // [s] of this call; length of the next step
  double stop_ = kInf;                      // [s] forces are not looked at later in this step
  double work_ = 0, effort_ = 0;            // [J] of this call; the sum of the parts' absolute values
  double least_weight_ = kInf;              // [J] least potential energy of weight in this call
  double size_ = 0;                         // [m] largest radius of gyration
  double load_ = 0;                         // [N] the largest normal force since the modes were decided
  bool no_answer_ = false;                  // an impact or an acceleration-level problem was not solved
  bool good_ = false;                       // the last call ended at last_q_, last_v_
  Eigen::VectorXd last_q_, last_v_;
  Lead lead_;
  JointRank joints_;
  Eigen::VectorXd least_q_;  // where they are least independent in the trial step, of redundant joints
  Flight flight_;
  Crowd crowd_;
  CrowdCrossing crossing_;
  Scale scale_;
  Strike strike_;
  Freed freed_;
  Stage stage_;
  Eigen::VectorXd none_;  // zero
  Kinematics poses_;
  std::vector<Bounces> bounces_;
  StageQuadrature flow_;  // forces of the lasting contacts, normal and tangent one each, and the power, in a trial step
  Eigen::VectorXd force_;  // of flow_, at one place
  double projected_ = 0;   // by the projection of the trial step, the largest entry over its scale
  double behind_ = 0;      // [s] of the trial step: gone on without forces, across a jump of theirs
  std::vector<ContactMode> before_;
  std::vector<RateTarget> targets_;
  const bool conservative_;   // nothing but contacts dissipates, and nothing is driven
  const bool carries_;        // drives or moving surfaces do work
  const Formulation* shown_;  // by problem(); null: the transition
};

}  // namespace orthant
