// integrators/fixed_step/generalized_alpha.h — nonsmooth generalized-α: smooth motion integrated separately from
// contact impulses.
//
//   (1−α_m) a⁺ + α_m a = (1−α_f) s⁺ + α_f s           s: smooth acceleration, a: the acceleration-like variable
//   ṽ  = v + h ((1−γ) a + γ a⁺),      M s⁺ = f(t+h, q⁺, ṽ) + G(q⁺)ᵀ λ,   G(q⁺) ṽ = 0
//   q⁺ = q + h v + h² ((½−β) a + β a⁺) + M̂⁻¹ (Gᵀ μ_G + W_Nᵀ μ_N + W_Tᵀ μ_T),   Φ(q⁺) = 0,  0 ≤ μ_N ⊥ g_N(q⁺) ≥ 0
//   v⁺ = ṽ + M̂⁻¹ (Gᵀ P_G + W_Nᵀ P_N + W_Tᵀ P_T),   0 ≤ P_N ⊥ γ_N⁺ + e γ_N⁻ ≥ 0 where μ_N > 0
//   the two stages of two_level.h, M̂ = M + h²β' K + hγ' C.  α_m = (2ρ−1)/(ρ+1), α_f = ρ/(ρ+1), γ = ½ + α_f − α_m,
//   β = (γ+½)²/4: the spectral radius falls from 1 to ρ = ρ_∞ as ω h grows, for stiff springs without bound.
//   Stages and smooth acceleration are coupled by fixed-point passes (2 or 3), each a Newton step for s⁺.
// s and a are kept from step to step, started with the accelerations consistent with joints. They contain no contact
// forces: a contact, lasting or not, acts by μ and P alone. Friction in the position stage is an addition to the
// source.
// Energy swings with h² while a mechanism turns: N-four-bar, h = 1e-3, 8.3e-4 J of 36 J within a turn, 6e-6 J after
// five.
// In space v, a and s stand in the bodies' axes, q⁺ = q exp(…) (Lie group), and f has −ω × Jω.
// Order 2 on smooth motion for every ρ_∞; 1 with impacts and, on curved paths, in contacts that last. Dampers act on ṽ,
// without the change by P.
// Source: Brüls, Acary & Cardona, CMAME 281 (2014) 131-161; Chung & Hulbert, J. Appl. Mech. 60 (1993) 371-375; Arnold &
// Brüls, Multibody Syst. Dyn. 18 (2007) 185-202.
#pragma once

#include <orthant/integrators/fixed_step/two_level.h>

namespace orthant {

struct GeneralizedAlphaOptions {
  double rho_inf = 0.8;
  template <class V> void visit(V&& v) { v("rho_inf", rho_inf, 0.0, 1.0); }
};

template <class Space> class GeneralizedAlphaOf final : public TwoLevelOf<Space> {
 public:
  using System = SystemOf<Space>;
  static constexpr std::string_view kName = "generalized-alpha";
  static constexpr Capabilities kCan{.impact_laws = false, .loaded_friction = false};
  using Options = GeneralizedAlphaOptions;
  explicit GeneralizedAlphaOf(const System& system, const Options& options = {});
  StepReport step(double h, Solver& solver, State& x) override;
  void remember(CheckpointData& memory) override {
    TwoLevelOf<Space>::remember(memory);
    memory(s_, a_, q_last_, v_last_, added_, stiffened_);
  }

 private:
  using TwoLevelOf<Space>::system_;
  using TwoLevelOf<Space>::fail;
  using TwoLevelOf<Space>::begin;
  using TwoLevelOf<Space>::factorize;
  using TwoLevelOf<Space>::reach;
  using TwoLevelOf<Space>::freeze_poses;
  using TwoLevelOf<Space>::hand_over;
  using TwoLevelOf<Space>::strike;
  using TwoLevelOf<Space>::arrive;
  using TwoLevelOf<Space>::start_;
  using TwoLevelOf<Space>::end_;
  using TwoLevelOf<Space>::q_end_;
  using TwoLevelOf<Space>::basic_;
  using TwoLevelOf<Space>::geometric_;
  using TwoLevelOf<Space>::added_;
  using TwoLevelOf<Space>::stiffened_;
  using TwoLevelOf<Space>::far_;
  using TwoLevelOf<Space>::force_;
  using TwoLevelOf<Space>::rate_;
  using TwoLevelOf<Space>::lambda_;

  bool start(const State& x, StepReport& report);                           // s_ and a_ where x is not the last one
  bool flow(double h, const State& x, Solver& solver, StepReport& report);  // s_new_, path_, v_ = ṽ

  double alpha_m_, alpha_f_, gamma_, beta_;
  Eigen::VectorXd s_, a_, s_new_, path_, change_, v_, q_last_, v_last_, path_known_, v_known_;
};
extern template class GeneralizedAlphaOf<Planar>;
extern template class GeneralizedAlphaOf<Spatial>;
using GeneralizedAlpha = GeneralizedAlphaOf<Planar>;

}  // namespace orthant
