// integrators/step/impact.h — impact laws: Newton's and Poisson's restitution, simultaneous and sequential impacts.
// Newton's law on all contacts at once needs no stage: rate_targets.h sets −e γ_N⁻ as the target of the step.
//
//   The impact takes v⁻ to v^E at one instant, before the step's forces act:
//   newton   γ_N⁺ ≥ −e γ_N⁻ and γ_T⁺ → −e_T γ_T⁻ for the contacts that strike.
//   poisson  in two phases, both with Coulomb friction on that phase's own normal impulse:
//              compression   0 ≤ Λ_C ⊥ γ_N ≥ 0,            Λ_TC ∈ −μ Λ_C Sgn(γ_T)
//              expansion     0 ≤ Λ_E − e Λ_C ⊥ γ_N ≥ 0,    Λ_TE ∈ −μ Λ_E Sgn(γ_T + e_T γ_T⁻)
//            so that e relates impulses: no contact releases more than e times what it stored, unless another presses
//            on it. (Tangential restitution over the whole impact, as in Newton's law; the source stores tangential
//            impulses instead.)
//   simultaneous   all closed contacts strike together.
//   sequential     the one that approaches fastest strikes alone, then the next, until none approaches. Contacts that
//                  approach equally fast (to 1e-9 of it) strike together: the order in the scene has no effect.
//                  Infinite sequences (e < 1 between several bodies) converge geometrically; below 1e-10 of the first
//                  approach the remaining approach is stopped at once. More than kMostImpacts end the step as
//                  iteration_limit.
//   Then the step's problem (forces, and impulses that hold what has struck at γ^E): γ_N⁺ ≥ γ_N^E where a contact
//   struck.
//   A single contact gives Newton's result by every one of these, to the last force h f.
// Cost: nothing while no contact approaches faster than kRestSpeed; else poisson two more problems of the step's size,
// sequential one (poisson: two) of one contact per impact.
// Energy: Newton's law with friction, or with different e, can raise it; energy_rise() measures that.
// Source: Glocker & Pfeiffer, Nonlinear Dynamics 7 (1995) 471-497; Pfeiffer & Glocker (1996), ch. 8; Kane & Levinson,
// Dynamics: Theory and Applications (1985), 5.8 (the rise); Ivanov, J. Appl. Math. Mech. 59 (1995) 887-902 (order).
#pragma once

#include <orthant/integrators/step/formulate.h>

namespace orthant {

template <class Space> class ImpactOf {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;
  using Row = RowOf<Space>;
  using RateTarget = RateTargetOf<Space>;
  using Impulse = ImpulseOf<Space>;
  using BasicSystem = BasicSystemOf<Space>;

  static constexpr int kMostImpacts = 100000;

  explicit ImpactOf(const System& system, Form form = Form::reduced);

  /// Whether the scene asks for more than Newton's law on all contacts at once.
  bool has_law() const { return restitution_ == Restitution::poisson || impacts_ == Impacts::sequential; }

  /// Where has_law(): lets the closed contacts of `terms` strike at the velocities `before`, and adds to v what that
  /// does. targets (Newton's law on entry): of those that struck, normal becomes what they are left with. False: report
  /// and why() say so.
  bool strike(const Terms& terms, const BasicSystem& basic, const Eigen::VectorXd& before,
              std::vector<RateTarget>& targets, Eigen::VectorXd& v, Solver& solver, StepReport& report);

  /// Ends an accumulation of impacts that several contacts strike in turn, at ever shorter intervals. Applies, at one
  /// instant, those of its infinitely many impacts that approach faster than 1e-10 of the first one (at most 1000).
  /// The contacts of in_turn (one flag per contact of the scene) strike one after the other, the fastest first. All
  /// other closed contacts take part each time. v: before, then after.
  /// Striking at one instant changes the share of friction: the slower the series decays, the more.
  bool strike_in_turn(const Terms& terms, const BasicSystem& basic, const std::vector<char>& in_turn,
                      Eigen::VectorXd& v, Solver& solver, StepReport& report);

  /// Adds the impulses of the last strike, if it was one.
  void add_to(std::vector<Impulse>& impulses) const;
  /// Of the full form: those of the joints, one a row.
  void add_joints_to(Eigen::VectorXd& impulses) const;

  /// From now on impulses are brought to rounding (solvers/refinement.h).
  void refine() { formulation_.refine(); }
  /// See Formulation::anchor().
  void anchor(double t, const Eigen::VectorXd& q, double ahead = 0) { formulation_.anchor(t, q, ahead); }

  void remember(CheckpointData& memory) { memory(formulation_); }

  const std::string& why() const { return why_; }
  const FormulationOf<Space>& formulation() const { return formulation_; }

 private:
  /// The contacts that may (null: all), strike at v_ one after the other, the fastest first, until none approaches
  /// faster than kLeft of `first` [m/s]; any other contact strikes each time.
  bool one_by_one(const Terms& terms, const BasicSystem& basic, const std::vector<char>* may, double first,
                  Solver& solver, StepReport& report);
  /// The contacts struck_.closed strike at v_, by the law of restitution.
  bool act(const BasicSystem& basic, Solver& solver, StepReport& report);
  bool solve(Solver& solver, StepReport& report);
  void begin(const Terms& terms, const Eigen::VectorXd& v);

  const System& system_;
  Restitution restitution_;
  Impacts impacts_;
  Form form_;
  FormulationOf<Space> formulation_;
  Terms struck_;  // poses, joint rows, pairs and closed are used
  std::vector<RateTarget> targets_;
  std::vector<Impulse> sum_, one_;
  std::vector<double> approach_;
  Eigen::VectorXd v_, rate_, joint_sum_;
  bool any_ = false;
  std::string why_;
};
extern template class ImpactOf<Planar>;
extern template class ImpactOf<Spatial>;
using Impact = ImpactOf<Planar>;

/// Sets targets.free and free_slip, from the velocities before contacts act.
template <class Space>
void note_forces(const TermsOf<Space>& terms, const Eigen::VectorXd& v_free, std::vector<RateTargetOf<Space>>& targets);

/// Negative work [J] of a contact in the last step. A listed contact has the pair {-1, its number}.
struct ContactWork {
  Pair contact;
  double work = 0;
};
inline constexpr double kSameRows = 1e-9;   // of what impacts exchange: rounding
inline constexpr double kOtherRows = 1e-2;  // likewise, where γ⁻ and γ⁺ are those of different poses

/// Rise of kinetic energy [J] by the impulses of a step with an impact, Σ ½ (γ⁺ + γ_free) Λ over the closed contacts.
/// Returns 0 unless the rise exceeds each of three limits:
///   Σ |Λ| |γ_free − γ⁻|, the possible share of the step's forces;
///   `small` times the exchanged energy Σ ½ (|γ⁺| + |γ_free|) |Λ|;
///   a tenth of `small` (at least 1e-9) times the whole kinetic energy.
/// Slip is relative to the moving surface, so that the work of a belt does not count. From kOtherRows on, schemes that
/// push gaps open (targets.least) are reported, too: they shoot off bodies that move by their own size in a step.
/// An impact may need two steps: a contact may return the work that it took in the step before. `taken` stores this
/// work; null: it is not stored.
template <class Space> double energy_rise(const SystemOf<Space>& system, const TermsOf<Space>& terms,
                                          const std::vector<RateTargetOf<Space>>& targets, const Eigen::VectorXd& v,
                                          const std::vector<ImpulseOf<Space>>& impulses, double small = kSameRows,
                                          std::vector<ContactWork>* taken = nullptr);

}  // namespace orthant
