// integrators/fixed_step/rattle.h — nonsmooth RATTLE: symplectic between impacts, joints and gaps held at both levels.
//
//   (M + h/2 C) (u − v) = h/2 f(t, q, v) + G(q)ᵀ Λ₁ + W(q)ᵀ R,   q⁺ = q + h u,  Φ(q⁺) = 0,  0 ≤ R_N ⊥ g_N(q⁺) ≥ 0
//   M (v⁺ − u) = h/2 f(t+h, q⁺, u) + G(q⁺)ᵀ Λ₂ + W(q⁺)ᵀ (P − R),  G(q⁺) v⁺ = 0,
//   0 ≤ P_N ⊥ γ_N⁺ + e γ_N⁻ ≥ 0 where R_N > 0, else P = 0
//   with Coulomb friction of both R (slip u) and P (γ_T⁺ + e_T γ_T⁻): the two stages of two_level.h. P is the whole
//   impulse of the step, so that Newton's law holds for it as in Moreau–Jean; R only stops the body at the surface.
//   In the plane, where a body strikes the ground and rebounds, −R acts along W(q)ᵀ: R W as it turns within the step
//   takes energy from a body that spins, at every impact. Free bodies keep W(q⁺)ᵀ, which keeps angular momentum.
// Order 2 on smooth motion and in contacts that last. With impacts 1: each ends on the surface and rebounds at the end
// of its step, wherever it fell, at the speed of its instant (two_level.h): O(h) in phase, not in energy. Inelastic
// ones get exactly the impulse of their instant within the step: order 2 is observed on the slider-crank for e = 0.
// Energy oscillates with h² while a mechanism turns, without drift: N-four-bar, h = 1e-3, 3.9e-4 J of 36 J within a
// turn, 5e-6 J after five; not a matter of its singular poses.
// Where loaded joints let light bodies swing at ω h > 1 (geometric_stiffness.h), M + h² K is M in both halves: stable.
// Explicit else: a spring's ω h must stay below 2. Dampers: implicit in the first half, explicit in the second.
// A step without contact: 1 factorization, 2 evaluations of forces, 3 or 4 of Φ.
// In space u and v stand in the bodies' axes, q⁺ = q exp(h u) (Lie group), and each half has an impulse of turning axes
// (half_turning_impulse() of gyroscopic.h): the step of the discrete Lagrangian h u · M u / 2. A free body keeps its
// angular momentum to rounding, and its energy swings with h² without drift. The first half is implicit in u and found
// by repetition, a position stage each.
// Source: Breuling, Capobianco, Eugster & Leine, Nonlinear Analysis: Hybrid Systems 52 (2024) 101469; Andersen, J.
// Comput. Phys. 52 (1983) 24-34; Hairer, Lubich & Wanner, Geometric Numerical Integration (2006), VII.1.4; in space
// Bou-Rabee & Marsden, Found. Comput. Math. 9 (2009) 197-219.
#pragma once

#include <orthant/integrators/fixed_step/two_level.h>
#include <orthant/integrators/step/gyroscopic.h>
#include <orthant/solvers/linear_algebra/anderson.h>

namespace orthant {

struct RattleOptions {
  template <class V> void visit(V&&) {}
};

template <class Space> class RattleOf final : public TwoLevelOf<Space> {
 public:
  using System = SystemOf<Space>;
  using Impulse = ImpulseOf<Space>;
  using ClosedContact = ClosedContactOf<Space>;
  static constexpr std::string_view kName = "rattle";
  static constexpr Capabilities kCan{.impact_laws = false, .loaded_friction = false};
  using Options = RattleOptions;
  explicit RattleOf(const System& system, const Options& options = {});
  StepReport step(double h, Solver& solver, State& x) override;
  void remember(CheckpointData& memory) override {
    TwoLevelOf<Space>::remember(memory);
    memory(last_, added_, stiffened_);
    factorized_there_ = false;
  }
  /// Whether contact k of closed() struck the ground in the last step, faster than the forces of the step make it, with
  /// restitution. h, x: of that step and its start.
  bool rebounds(std::size_t k, double h, const State& x) const;

 private:
  using TwoLevelOf<Space>::system_;
  using TwoLevelOf<Space>::impulses_;
  using TwoLevelOf<Space>::fail;
  using TwoLevelOf<Space>::begin;
  using TwoLevelOf<Space>::factorize;
  using TwoLevelOf<Space>::reach;
  using TwoLevelOf<Space>::friction_carried;
  using TwoLevelOf<Space>::hand_over;
  using TwoLevelOf<Space>::strike;
  using TwoLevelOf<Space>::arrive;
  using TwoLevelOf<Space>::start_;
  using TwoLevelOf<Space>::end_;
  using TwoLevelOf<Space>::basic_;
  using TwoLevelOf<Space>::geometric_;
  using TwoLevelOf<Space>::added_;
  using TwoLevelOf<Space>::stiffened_;
  using TwoLevelOf<Space>::force_;
  using TwoLevelOf<Space>::rate_;
  using TwoLevelOf<Space>::lambda_;

  bool half_kick(double h, const State& x, StepReport& report);   // path_ predicted, without contacts
  bool other_half(double h, const State& x, StepReport& report);  // v_ without P
  void predict(double h, const State& x);                         // path_ = h u, of force_
  /// Space: predict(), repeated until turning_ is that of u.
  bool predict_turning(double h, const State& x, StepReport& report);
  /// reach(); in space repeated likewise.
  bool reach_turning(double h, const State& x, Solver& solver, StepReport& report);
  /// Space: turning_ becomes that of path_, or what converges faster. True: it is so already.
  bool turn_again(double h, int pass);
  bool check_turn(bool found, StepReport& report);
  void note_carried();  // space: carried_, of impulses_ and start_

  Eigen::VectorXd path_, v_, last_;
  bool factorized_there_ = false;         // basic_ and end_ are those at last_
  Eigen::VectorXd wanted_rate_;           // of joints, for predict()
  Eigen::VectorXd half_force_, turning_;  // space: h/2 f; impulse of the first half's turning
  Eigen::VectorXd next_, scale_;          // likewise: the next one; 1/√M
  bool fits_ = true;                      // likewise: no body turns too far
  Anderson anderson_;                     // likewise
  std::vector<Vector3d> carried_;         // likewise: R_T in the world, one a contact [kg m]
};
extern template class RattleOf<Planar>;
extern template class RattleOf<Spatial>;
using Rattle = RattleOf<Planar>;

}  // namespace orthant
