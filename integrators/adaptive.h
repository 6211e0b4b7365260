// integrators/adaptive.h — Moreau–Jean stepping to a tolerance: of high order between events, of first order across them.
//
//   Arcs. The symmetric step, whose mean velocity satisfies joints and lasting contacts (θ = ½; e = e_T = 1 there):
//     q_m = q + h/2 v,   M̂ (v⁺ − v) = h f(t + h/2, q_m) + Gᵀ Λ_G + W_Nᵀ Λ_N + W_Tᵀ Λ_T,   q⁺ = q_m + h/2 v⁺,
//     G (v⁺ + v) = 0,   0 ≤ Λ_N ⊥ γ_N⁺ + γ_N ≥ 0,   Λ_T ∈ −μ Λ_N Sgn(γ_T⁺ + γ_T).
//   While the same contacts last, and stick or slide the same way, this is a symmetric method for a smooth motion: its
//   error is a series in h² (over even numbers of steps: off the joints' manifold v alternates). An arc is done with
//   2, 4, 6, … of them, extrapolated to order 4, 6, … (Aitken–Neville); the last two columns differ by the error, and
//   how many pay is decided by work per second. Then q and v are projected onto the joints.
//   Events end an arc: a gap that closes, a contact force that ends, a slip that ends or begins. When, is foretold from
//   the gaps, forces and slips looked at; the arc stops just short, and one plain Moreau–Jean step with the scene's own
//   laws goes across. Its error (against the same step in two halves, and a bound for what these may overlook) is of first
//   order where the velocity jumps, so it is as short as the tolerance asks. A contact closed in both halves that does not
//   open lasts from then on: that is how the infinitely many impacts of an accumulation end, without a rule of their own.
//   Error norm: max |Δ| / (atol + rtol s); s = 1 rad for angles, else the scene's largest |x|, |ẋ|, |ω| at that time.
//   atol is in m, rad, m/s, rad/s alike. Measured on the slider-crank: |Δθ₁| after 3 turns is about rtol, from 1e-3
//   (2 ms) over 1e-6 (5 ms) to 3e-8 (10 ms), where rounding of the gaps ends it.
//   Cost: an arc of k columns k (k + 1) steps, each one factorization and one small complementarity problem.
//   Between the points looked at a gap or a slip is held against the parabola through the last three: where it may dip
//   to zero an arc ends, and it is looked at anew from there. No load or drive swings by more than 3 rad in an arc.
//   Limits: a dip narrower than that shows can be missed, so can a contact force that ends and comes back. Flights no higher than
//   rounding of the coordinates are not told from rest. Where static friction exceeds kinetic, the instant of letting go
//   is known to some 1e-7 s at best. Lasting contacts keep the gap at which they were made (within the tolerance); joints
//   hold to rounding. Motion that depends discontinuously on its start (corners that strike almost together) is followed,
//   but no tolerance makes it converge. Where events crowd (200 steps and rejected ones that come on by less than a
//   microsecond each, on the average) crossings are not made shorter than 1e-6 s, later 2e-6, … 1e-4 s, whatever their
//   error, until it is calm again. A step ends where a load jumps or bends (its breakpoints).
// Source: Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), V; Deuflhard, SIAM Review 27 (1985) 505-535;
// Acary, Applied Numerical Mathematics 62 (2012) 1259-1275 (higher order event capturing).
#pragma once

#include <orthant/integrators/impact.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/projection.h>

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
  const Lcp& problem() const override { return formulation_.problem(); }

 private:
  enum class Mode : char { open, slides, sticks };
  enum class Outcome { done, impact, change, dip, failed };
  struct Margin {  // what keeps a contact in its mode, at the last three points looked at
    struct Sample {
      double t = -kInf, value = 0;
    };
    std::array<Sample, 3> last;  // the newest first
    void add(double t, double value) { last = {{{t, value}, last[0], last[1]}}; }
    double end() const;
    double dip(double noise) const;
  };
  struct Lasting {
    Mode mode = Mode::open;
    double slip = 0;         // its sign, of a contact that slides
    Margin normal, tangent;  // an open contact's normal margin is its gap
  };

  void restart(double h);
  bool finish(double taken, State& x, StepReport& report);
  bool pass(bool jumps, double taken, double left, Solver& solver, State& x, StepReport& report);
  void watch_crowd(double t);
  void give_up(const State& x, StepReport& report);
  void load(const State& x);
  void store(Eigen::VectorXd& y) const;
  Outcome arc(double h, Solver& solver, const State& x, StepReport& report);
  Outcome extrapolate(double h, Solver& solver, const State& x, StepReport& report);
  Outcome symmetric_step(const State& x, double offset, double h, Solver& solver, StepReport& report);
  bool closes(const State& x, double offset);
  bool ends(const State& x, double h);
  bool in_mode(const State& x, double offset, double h);
  void look(Margin& margin, const State& x, double offset, double value, double noise);
  double plan(double taken);
  bool cross(double h, bool jumps, Solver& solver, const State& x, StepReport& report);
  bool plain_step(const State& x, double offset, double h, Solver& solver, StepReport& report);
  bool predict(double t, double h);
  bool solve(Solver& solver, const std::vector<ContactLaw>& laws, StepReport& report);
  void drift(double h);
  bool settle_modes(double h, const State& x);
  bool accept(double h, State& x, StepReport& report);
  bool bind(Solver& solver, State& x, StepReport& report);
  void scale(const State& x);
  double error(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  ContactRows rows(int contact) const;

  Options options_;
  Terms terms_;
  BasicSystem basic_;
  Projection projection_;
  Formulation formulation_;
  std::vector<Wanted> wanted_;
  std::vector<ContactLaw> laws_;           // of the step being done
  std::vector<Lasting> lasting_, before_;  // before_: at the start of the arc or crossing
  std::vector<bool> closed_;               // in the first half of a crossing
  std::vector<Eigen::VectorXd> row_;       // q, v, Σ Λ of every column of the extrapolation
  Eigen::VectorXd q_, v_, v_new_, v_half_, force_, lambda_;
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
  double horizon_ = kInf;            // [s] from where the arc or crossing begins, see horizon.h
  double dip_ = kInf;                // [s] likewise: where a margin is least, and nearly 0 or below
  double slack_ = 0;  // [m] what rounding makes of a gap of 0: closed in a crossing, so that corners go together
  double error_ = 0;
  double rise_ = 0;                 // [J] of energy, in the impacts of a crossing
  std::array<double, 4> weight_{};  // lengths, angles, speeds, angular velocities
};

}  // namespace orthant
