// integrators/fixed_step/stewart_trinkle.h — Stewart–Trinkle stepping: the linearized gap at the end is unilateral.
//
//   The step of velocity_stepping.h with a = ½, θ = 1 (q⁺ = q + h v⁺), polyhedral Coulomb friction, and
//     0 ≤ Λ_N ⊥ g_N/h + γ_N⁺ ≥ 0,
//   linearized about the end of free flight, q + h v_free: g_N there stands for g_N + h γ_N,free. Contacts whose gap is
//   positive there and stays so under the others' impulses have no rows. So a contact is made with g_N = 0, and what
//   penetration there is (curvature, a start) is taken back in the next step; at no more than a quarter of the
//   surfaces' relative speeds, so that an initial penetration does not throw bodies apart.
//   Restitution is not in the source. Here a candidate with e > 0 rebounds in the step before the gap is used up:
//     γ_N⁺ ≥ max(−e γ_N⁻, −g_N/h),  at a gap of up to h |γ_N⁻|,
//   γ_N⁻ with the rows of the step's start. A curved path changes γ_N by h Ẇ_N v in a step; an approach no faster than
//   that is a contact that lasts, and does not rebound.
// Order 1, on smooth motion too (q⁺ uses the velocity at the end).
// Source: Stewart & Trinkle, Int. J. Numer. Meth. Engng 39 (1996) 2673-2691; Stewart, SIAM Review 42 (2000) 3-39.
#pragma once

#include <orthant/integrators/fixed_step/gap_stepping.h>

namespace orthant {

template <class Space> class StewartTrinkleOf : public GapSteppingOf<Space> {
 public:
  using System = SystemOf<Space>;
  using ClosedContact = ClosedContactOf<Space>;
  using Terms = TermsOf<Space>;
  static constexpr std::string_view kName = "stewart-trinkle";
  static constexpr Capabilities kCan{.turning_friction = true};
  using Options = VelocitySteppingOptions;
  explicit StewartTrinkleOf(const System& system, const Options& options = {})
      : StewartTrinkleOf(system, options, Cone::coulomb, kName, kCan) {}

 protected:
  StewartTrinkleOf(const System& system, const Options& options, Cone cone, std::string_view name,
                   const Capabilities& can)
      : GapSteppingOf<Space>(system, name, can, {0.5, 1, options.joints, options.form, cone, options.sleep}),
        cone_(cone),
        start_(system) {}

 private:
  using Step = typename GapSteppingOf<Space>::Step;
  using GapSteppingOf<Space>::closing;

  double least(const Step& step, const ClosedContact& c, const Eigen::VectorXd& v) const final;
  void set_targets(Step& step) final;
  double reach(const Step& step) const final;
  void find_approaches(const Step& step);

  Cone cone_;
  Terms start_;  // rows at the step's start, of what approaches and may rebound
};
extern template class StewartTrinkleOf<Planar>;
extern template class StewartTrinkleOf<Spatial>;
using StewartTrinkle = StewartTrinkleOf<Planar>;

}  // namespace orthant
