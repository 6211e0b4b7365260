// integrators/fixed_step/two_level.h — two-level schemes: joints and contacts at position and at velocity level.
//
//   Position stage: from a predicted displacement p of the step and rows G, W frozen where `start` stands, find
//     p⁺ = p + M̂⁻¹ (Gᵀ μ_G + W_Nᵀ μ_N + W_Tᵀ μ_T)  with  Φ(q + p⁺) = 0,   0 ≤ μ_N ⊥ g_N(q + p⁺) ≥ 0,
//     and Coulomb's law between μ_T and the slip W_T p⁺; dry friction in joints up to h²/2 times its bound.
//   By simplified Newton steps (the matrix stays, Φ and g_N are evaluated again), each one solve with the joints and,
//   where a gap would close, one complementarity problem, until Φ is at rounding (each row by its own bodies,
//   magnitudes.h) and g_N too, or as near as the solver comes, or no iterate comes nearer than 1e-11 m. Contacts whose
//   gap is negative at an iterate get rows, the others have none. Where that converges slowly (next to a singular pose;
//   a step much too large) the rows are frozen again at the iterate. μ [kg m] is an impulse times a time.
//   Velocity stage: impulses P at the end of the step, its contacts those of the position stage with μ_N > 0, or which
//   have come to touch:
//     0 ≤ P_N ⊥ γ_N⁺ + e γ_N⁻ ≥ 0,   P_T ∈ −μ P_N Sgn(γ_T⁺ + e_T γ_T⁻),   G v⁺ = 0,
//   γ⁻ with the rows and the velocities of the step's start, so that a lasting contact has γ_N⁻ = 0 on curved paths
//   too. Where a gap s closes within the step, γ_N⁻ is the rate at the surface: γ_N² = γ_N(t)² − 2 a s, all with the
//   rows of the step's end, a = (γ_N,free(t+h) − γ_N(t)) / h. So an impact with e = 1 keeps the energy, wherever in the
//   step it falls; its phase errs by O(h). Not where rows or forces change γ_N by more than a quarter in the step: a
//   body may be held by other contacts, whose forces a does not contain.
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/mechanics/dynamics/geometric_stiffness.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/impact.h>
#include <orthant/integrators/step/in_plane.h>
#include <orthant/integrators/step/magnitudes.h>
#include <orthant/integrators/step/spatial_tunnelling.h>

namespace orthant {

template <class Space> class TwoLevelOf : public IntegratorOf<Space> {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;
  using Impulse = ImpulseOf<Space>;
  using ClosedContact = ClosedContactOf<Space>;
  using Formulation = FormulationOf<Space>;

  void remember(CheckpointData& memory) override;
  const Lcp& problem() const final { return shown_->problem(); }
  std::span<const Pair> pairs() const final { return end_.pairs; }
  /// Of the last step, for its derivative: the contacts that carried or touched at its end, with their rows there and
  /// at its start, and the targets of their rates; both stages' problems.
  const std::vector<ClosedContact>& closed() const { return end_.closed; }
  const std::vector<ClosedContact>& closed_at_start() const { return start_.closed; }
  const std::vector<RateTargetOf<Space>>& targets() const { return targets_; }
  const Formulation& positions() const { return positions_; }
  const Formulation& velocities() const { return velocities_; }
  /// Whether the position stage froze its rows at an iterate.
  bool froze_again() const { return froze_again_; }

 protected:
  using IntegratorOf<Space>::system_;
  using IntegratorOf<Space>::gaps_;
  using IntegratorOf<Space>::impulses_;
  using IntegratorOf<Space>::frictions_;
  using IntegratorOf<Space>::why_;
  using IntegratorOf<Space>::touching;
  using IntegratorOf<Space>::fail;
  using IntegratorOf<Space>::pool;

  TwoLevelOf(const System& system, std::string_view name, const Capabilities& can);

  void begin();  // nothing solved, nothing said

  /// G at terms.at, factorized with the springs' weights and what is added_: basic_, which both stages work with.
  bool factorize(Terms& terms, double stiffness_weight, double damping_weight, StepReport& report);

  /// Position stage about basic_ and start_.at: `path` from predicted to p⁺. end_.at, phi and gap are then those at
  /// q + p⁺, and impulses_ holds μ. False: the report and why() tell the reason.
  bool reach(double h, const State& x, Eigen::VectorXd& path, Solver& solver, StepReport& report);

  /// Poses of start_.at for the next pass: those of the last iterate, or, where passes swing (the normals of a small
  /// clearance turn by as much as the correction is long), on the way there, as far as Aitken's relaxation goes.
  void freeze_poses(bool swings);

  /// μ of dry friction i of the scene, of the last reach() [kg m] or [kg m²].
  double friction_carried(std::size_t i) const { return positions_.joint_friction(i); }

  /// Closes in end_ the contacts that carry μ_N > 0 or touch, and sets what is wanted of their rates, from x.
  void hand_over(const State& x);

  /// Velocity stage about basic_, factorized at end_.at: adds to v what P does; impulses_ holds P.
  bool strike(double h, Eigen::VectorXd& v, Solver& solver, StepReport& report);

  /// Takes the step: x is at q + p⁺ with v, and the report says how well it fits there.
  void arrive(double h, Eigen::VectorXd& v, State& x, StepReport& report);

  Terms start_, end_;      // where rows are frozen; at q_end_
  Eigen::VectorXd q_end_;  // x.q, moved by the path of the last iterate
  BasicSystemOf<Space> basic_;
  InPlane<Space, GeometricStiffness> geometric_;
  Eigen::VectorXd added_;   // dof: to M, of the joints' geometric stiffness
  bool stiffened_ = false;  // that counts
  Magnitudes far_, path_;   // [m] of the coordinates at hand; of the step
  Eigen::VectorXd force_, rate_, lambda_;

 private:
  bool close_gaps();                                  // more contacts than before
  bool freeze_here(bool swings, StepReport& report);  // start_ and basic_ move to end_.at
  struct Mismatch {                 // at end_: of joints, of closed contacts that push though open, of negative gaps
    double size = 0, relative = 0;  // [m, rad]; over what rounding makes of it
    bool none = true;               // it is no more than rounding, and accuracy of the gaps
  };
  /// Of a residual or gap with this row [m, rad].
  double rounding_of(const RowOf<Space>& row) const;
  Mismatch mismatch(double accuracy, std::size_t count) const;  // of the first `count` closed contacts
  bool touch_only(std::size_t known) const;  // those closed after these overlap within rounding: they need no push
  bool solve(Formulation& formulation, Solver& solver, StepReport& report);
  void strike_at_the_surface(double h);  // targets_: γ_N⁻ at the surface

  std::vector<char> has_rows_;  // one per contact: it stands in start_.closed
  BroadPhaseOf<Space> broad_phase_;
  TunnellingDetectorOf<Space> tunnelling_;
  Formulation positions_, velocities_;
  const Formulation* shown_;  // by problem()
  double stiffness_weight_ = 0, damping_weight_ = 0;
  std::vector<RateTargetOf<Space>> targets_;
  std::vector<double> ways_;  // [m] of targets_: by how much the gap closes in the step
  Eigen::VectorXd change_;    // of q in the step
  std::vector<int> carrying_;
  Eigen::VectorXd free_;
  Eigen::VectorXd q_frozen_, off_, off_before_;  // of start_.at; q_end_ from there, now and a pass before
  double part_ = 1;                              // of off_ that is gone
  bool froze_again_ = false;                     // in this step
};
extern template class TwoLevelOf<Planar>;
extern template class TwoLevelOf<Spatial>;
using TwoLevel = TwoLevelOf<Planar>;

}  // namespace orthant
