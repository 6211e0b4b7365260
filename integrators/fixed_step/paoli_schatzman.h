// integrators/fixed_step/paoli_schatzman.h — Paoli–Schatzman stepping: restitution over three positions.
//
//   M (q_{n+1} − 2 q_n + q_{n−1}) = h² f + h (Gᵀ Λ_G + W_Nᵀ Λ_N + W_Tᵀ Λ_T),
//   0 ≤ Λ_N ⊥ g_N((q_{n+1} + e q_{n−1}) / (1+e)) ≥ 0
//   With v_n = (q_n − q_{n−1})/h the state carries q_{n−1}, so that the first step and a change of h need nothing else,
//   and this is the step of velocity_stepping.h with a = ½, θ = 1 and
//     γ_N⁺ ≥ e γ_N⁻ − (1+e) g_N/h,   linearized about the end of free flight, as in stewart_trinkle.h.
//   for the contacts that free flight, or the impulses of others, would let violate this (rows are evaluated for all:
//   O(contacts) a step).
//   An impact takes two steps: one ends at g_N = −e g_{N,n−1}, a penetration of O(h), the next has the velocity −e
//   γ_N⁻.
//   Coulomb friction is added at velocity level; the source has none. It acts in both steps of an impact, each with
//   that step's normal impulse: where slip stops or turns between them, or couples with the normal, that is another law
//   than Newton's with friction in one impact. Tangential restitution would act twice: it is refused.
// Order 1: v is a backward difference, half a step late. g_N/h carries the rounding of gaps into velocities: ties
// between contacts (a face on two corners) are lost from h = 1e-6 s or so down.
// Source: Paoli & Schatzman, SIAM J. Numer. Anal. 40 (2002) 702-733 and 734-768.
#pragma once

#include <orthant/integrators/fixed_step/gap_stepping.h>

namespace orthant {

template <class Space> class PaoliSchatzmanOf final : public GapSteppingOf<Space> {
 public:
  using System = SystemOf<Space>;
  using ClosedContact = ClosedContactOf<Space>;
  static constexpr std::string_view kName = "paoli-schatzman";
  static constexpr Capabilities kCan{.impact_laws = false, .tangential_restitution = false, .turning_friction = true};
  using Options = VelocitySteppingOptions;
  explicit PaoliSchatzmanOf(const System& system, const Options& options = {})
      : GapSteppingOf<Space>(system, kName, kCan,
                             {0.5, 1, options.joints, options.form, Cone::coulomb, options.sleep}) {}

 private:
  using Step = typename GapSteppingOf<Space>::Step;
  using GapSteppingOf<Space>::closing;

  double least(const Step& step, const ClosedContact& c, const Eigen::VectorXd& v) const override;
  void set_targets(Step& step) override;
};
extern template class PaoliSchatzmanOf<Planar>;
extern template class PaoliSchatzmanOf<Spatial>;
using PaoliSchatzman = PaoliSchatzmanOf<Planar>;

}  // namespace orthant
