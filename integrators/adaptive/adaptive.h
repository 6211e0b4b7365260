// integrators/adaptive/adaptive.h — Moreau–Jean stepping to a tolerance: of high order between events, of first order across them.
//
//   Arcs. The symmetric step, whose mean velocity satisfies joints and lasting contacts:
//     q_m = q + h/2 v,   M̂ (v⁺ − v) = h f(t + h/2, q_m) + Gᵀ Λ_G + W_Nᵀ Λ_N + W_Tᵀ Λ_T,   q⁺ = q_m + h/2 v⁺,
//     G (v⁺ + v) = 0,   lasting: W_N (v⁺ + v) = 0,   sticking: W_T (v⁺ + v) = 0,   sliding: Λ_T = −σ μ Λ_N.
//   While the same contacts last, and stick or slide the same way, this is a symmetric method for a smooth motion: its
//   error is a series in h² (over even numbers of steps: off the joints' manifold v alternates). An arc is done with
//   2, 4, 6, … of them, extrapolated to order 4, 6, … (Aitken–Neville); the last two columns differ by the error, and
//   how many pay is decided by work per second. Then q and v are projected onto joints and lasting contacts.
//   Events end an arc. A gap that closes is foretold from the gaps looked at; the arc stops just short, and one plain
//   Moreau–Jean step with the scene's own laws goes across. Its error (against the same step in two halves, and a bound for
//   what these may overlook) is of first order, so it is as short as the tolerance asks. A contact closed in both halves
//   that does not open lasts from then on. Two contacts that strike in turn, at ever shorter intervals (impact_series.h), and
//   both within one crossing: they go on there, one after the other at one instant, until they last (impact.h); else they
//   would strike together, and rebound. A force that ends, a cone that is left, a slip that stops shows in the true forces and slips at five
//   points of the arc (contact_watch.h), not in the steps' Λ, which alternate: the arc is done again to just after it (so
//   late that accelerations do 0.1 of the tolerance meanwhile), and the modes are decided by the problem at acceleration
//   level (contact_transition.h). Where that finds nothing new, or no answer, a step of Moreau–Jean goes on. Forces that are
//   not unique (redundant rows) end no mode while others exist with which all go on, at these five points.
//   Error norm: max |Δ| / (atol + rtol s); s = 1 rad for angles, else the largest |x|, |ẋ|, |ω| at that time of all bodies
//   that can meet (magnitudes.h).
//   atol is in m, rad, m/s, rad/s alike: an error of one step, which the motion may magnify. Measured on the slider-crank,
//   e <= 0.4: |Δθ₁| after 3 turns is about rtol, 1.6 of it at the most, from 1e-3 to 1e-7, and levels off at 1e-9 to 5e-8,
//   where rounding of the gaps ends it; with e = 0.7 up to 100, with e = 0.9 up to 1000 times rtol (μ = 0.1, event-driven
//   beside it).
//   Cost: an arc of k columns k (k + 1) steps, each one factorization and one small dense system of the lasting contacts,
//   and five more evaluations where contacts last.
//   Between the points looked at a gap is held against the parabola through the last three, if they do not rise: where it
//   may dip to zero an arc ends, and it is looked at anew from there. A contact just let go opens like t³, less than steps
//   know midway: its gap is looked at where the arc ends. No load or drive swings by more than 3 rad in an arc.
//   Where a lasting contact's normal jumps (a polygon's corner comes to an edge) landing would change more than the
//   tolerance allows: such an arc is not taken, but made shorter, and at last crossed. At tight tolerances that may end in
//   numerical_error instead.
//   Limits: a dip narrower than that shows can be missed. Flights no higher than rounding of the coordinates are not told
//   from rest. Joints and lasting contacts hold to rounding: the gap within the tolerance at which a contact was made goes.
//   Motion that depends discontinuously on its start is followed as long as the tolerance tells its events apart, and series
//   of two contacts to their limit. Painlevé's paradox is passed over by a crossing, without a word. Where events crowd (200 steps and rejected ones that come on by less than a
//   microsecond each, on the average) crossings are not made shorter than 1e-6 s, later 2e-6, … 1e-4 s, whatever their
//   error, until it is calm again. A step ends where a load jumps or bends (its breakpoints).
// Source: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), V; Deuflhard, SIAM Review 27 (1985) 505-535;
// Acary, Applied Numerical Mathematics 62 (2012) 1259-1275 (higher order event capturing).
#pragma once

#include <orthant/integrators/between_events/contact_transition.h>
#include <orthant/integrators/between_events/contact_watch.h>
#include <orthant/integrators/step/impact.h>
#include <orthant/integrators/between_events/impact_series.h>

#include <array>

namespace orthant {

struct AdaptiveOptions {
  double rtol = 1e-6, atol = 1e-9;  // of one step, see above
  int columns = 4;                  // of the extrapolation, at the most: order 2 columns
  int max_steps = 1000000;          // inner steps and rejected ones of one call
  template <class V> void visit(V&& v) {
    v("rtol", rtol, 0.0, 1.0), v("atol", atol, 1e-15, 1.0), v("columns", columns, 2, 5),
        v("max_steps", max_steps, 1, 2000000000);
  }
};

class Adaptive final : public Integrator {
 public:
  using Options = AdaptiveOptions;
  explicit Adaptive(const System& system, const Options& options = {});
  StepReport step(double h, Solver& solver, State& x) override;
  void remember(Memory& memory) override;
  const Lcp& problem() const override { return formulation_.problem(); }

 private:
  static constexpr double kNone = 1e-4;   // of the tolerance
  static constexpr double kNoise = 0.01;  // of the tolerance: slips and gaps are looked at no closer
  enum class Outcome { done, impact, change, dip, failed };
  struct Margin {  // an open contact's gap, at the last three points looked at
    struct Sample {
      double t = -kInf, value = 0;
    };
    std::array<Sample, 3> last;  // the newest first
    void add(double t, double value) { last = {{{t, value}, last[0], last[1]}}; }
    double dip(double noise) const;
  };

  void restart(double h);
  void finish(double taken, State& x, StepReport& report);
  bool pass(double taken, double left, Solver& solver, State& x, StepReport& report);
  bool change(double taken, double left, Solver& solver, State& x, StepReport& report);
  bool decide(Solver& solver, State& x, StepReport& report);
  void note_changes(double t);
  double late() const;
  double crossing(double wish, double left) const;
  bool cross_here(bool jumps, double left, Solver& solver, State& x, StepReport& report);
  void watch_crowd(double t);
  void give_up(const State& x, StepReport& report);
  void end_series(double width, const State& x);
  void load(const State& x);
  void store(Eigen::VectorXd& y) const;
  Outcome arc(double h, Solver& solver, const State& x, StepReport& report);
  Outcome extrapolate(double h, const State& x);
  Outcome symmetric_step(const State& x, double offset, double h);
  Outcome examine(double h, Solver& solver, const State& x, StepReport& report);
  double mode_end(double t, double s, Solver& solver, StepReport& report);
  bool holds(double t, const MotionPoint& p, Solver& solver, StepReport& report);
  bool land(double t);
  void begin_margins(double t);
  bool closes(const State& x, double offset, bool midway);
  void look(int contact, const State& x, double offset, double value);
  double plan(double taken);
  bool cross(double h, bool jumps, double joints, Solver& solver, const State& x, StepReport& report);
  bool plain_step(const State& x, double offset, double h, double joints, Solver& solver, StepReport& report);
  bool predict(double t, double h, double joints);
  void settle_modes(double h, const State& x);
  void accept(double h, State& x, StepReport& report);
  void scale(const State& x);
  double error(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  ContactRows rows(int contact) const;

  Options options_;
  Terms terms_;
  BasicSystem basic_;
  ContactMotion motion_;  // its modes are those of the arc
  ContactWatch watch_;
  ContactTransition transition_;
  Impact strikes_;
  MotionPoint start_, end_;  // of an arc
  Formulation formulation_;
  std::vector<Wanted> wanted_;
  std::vector<ContactMode> before_;  // at the start of a crossing
  std::vector<ContactBias> missing_;
  std::vector<Margin> gap_margins_, gaps_before_;  // gaps_before_: at the start of the arc
  std::vector<bool> closed_;                       // in the first half of a crossing
  std::vector<double> half_rate_;                  // [m/s] of closed_ ones, at its end
  std::vector<ImpactSeries> series_;               // of each contact
  std::vector<double> released_;                   // [s] when each last ended to last
  std::vector<char> over_;                         // in a crossing: the contact's series ends within
  bool in_turn_ = false;                           // there are such contacts
  std::vector<Eigen::VectorXd> row_;               // q, v of every column of the extrapolation
  Eigen::VectorXd q_, v_, v_new_, v_before_, v_half_, from_, force_, rate_, lambda_;
  std::vector<Impulse> sum_;
  std::vector<Impulse> kick_;
  Eigen::VectorXd none_;
  State last_;                                // what was returned
  double arc_ = 0, impact_ = 0, change_ = 0;  // [s] step sizes to try next: of arcs and of crossings
  double floor_ = 0, crowd_since_ = 0;        // [s] of crossings where they crowd; since when crowd_ steps are counted
  int crowd_ = 0;
  int aim_ = 2;                     // columns
  std::array<double, 6> errors_{};  // by columns, of the last arc
  int columns_ = 0;                 // of the last arc
  Kinematics at_start_;
  double limit_ = kInf, least_ = 0;  // [s] of the next arc; the shortest step that moves t
  double event_ = 0;                 // [s] from the start of the step: the event foretold
  double horizon_ = kInf;            // [s] from where the arc or crossing begins, see look_ahead.h
  double late_ = 0,
         decided_ = -kInf;  // [s] how late after its end a mode is changed; when modes were decided at a standstill
  double dip_ = kInf;       // [s] likewise: where a margin is least, and nearly 0 or below
  double error_ = 0;
  bool jumped_ = false;                            // rows have, at the end of an arc
  double rise_ = 0;                                // [J] of energy, in the impacts of a crossing
  ContactMotion::Residual residual_;               // of the joints
  Extents far_, length_, speed_, omega_;           // of assemblies; of all that can meet
  std::vector<std::pair<BodyId, BodyId>> bodies_;  // of each contact
  std::vector<double>
      slack_;  // [m] what rounding makes of a gap of 0: closed in a crossing, so that corners go together
  std::vector<double> noise_;  // [m] gaps are looked at no closer
  Eigen::VectorXd weight_;     // of errors of q and v, 1 / (atol + rtol s)
};

}  // namespace orthant
