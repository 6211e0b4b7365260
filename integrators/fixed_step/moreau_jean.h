// integrators/fixed_step/moreau_jean.h — Moreau–Jean θ-stepping at velocity level; its step: velocity_stepping.h.
//
//   The step of velocity_stepping.h with a = θ: everything at q_θ = q + θ h v, and
//   closed: g_N(q_θ) ≤ 10⁻³ h² ‖M⁻¹ f‖;  0 ≤ Λ_N ⊥ γ_N⁺ + e γ_N⁻ ≥ 0,  Λ_T ∈ −μ Λ_N Sgn(γ_T⁺ + e_T γ_T⁻).
// The bound (of the bodies that can meet, magnitudes.h) is not 0 because impulses are rounded: under 1e6 kg they
// leave rates of 1e-12 m/s and more, a contact at rest would part for a step, and the light bodies of a stack would
// be shot off by the fall through such a gap.
// Of two points of polygons one that approaches is no contact yet where the faces' overlap ends before it is as deep
// as the other one (polygon_points.h): a corner that slides off an edge at the penetration that the scheme leaves
// strikes nothing.
// Order 1 with impacts; 2 on smooth motion for θ = ½ and symmetric joints. Gaps are evaluated, never corrected: a
// contact keeps the penetration, at most h |γ_N⁻|, at which it was closed. On a path of the radius ρ, a pin's in its
// bearing, some (h γ_T)² / 4ρ a step are added to that.
// Source: Moreau, Unilateral contact and dry friction in finite freedom dynamics (1988); Jean, CMAME 177 (1999)
// 235-257; Brogliato & Acary, Numerical Methods for Nonsmooth Dynamical Systems (2008), ch. 10.
#pragma once

#include <orthant/integrators/fixed_step/velocity_stepping.h>

namespace orthant {

struct MoreauJeanOptions {
  double theta = 0.5;
  Joints joints = Joints::symmetric;
  Form form = Form::reduced;
  SleepOptions sleep;
  template <class V> void visit(V&& v) {
    v("theta", theta, 0.5, 1.0), v("joints", joints, kJointsNames), v("form", form, kFormNames);
    v("sleep_after", sleep.after, 0.0, 1e9), v("sleep_speed", sleep.speed, 0.0, 1e3);
  }
};

template <class Space> class MoreauJeanOf final : public VelocitySteppingOf<Space> {
 public:
  using System = SystemOf<Space>;
  using ClosedContact = ClosedContactOf<Space>;
  static constexpr std::string_view kName = "moreau-jean";
  static constexpr Capabilities kCan{.turning_friction = true};
  using Options = MoreauJeanOptions;
  explicit MoreauJeanOf(const System& system, const Options& options = {})
      : VelocitySteppingOf<Space>(
            system, kName, kCan,
            {options.theta, options.theta, options.joints, options.form, Cone::coulomb, options.sleep, kParted}),
        polygons_(may_slide_off(system.scene())) {}

 private:
  using Step = typename VelocitySteppingOf<Space>::Step;

  static constexpr double kParted = 1e-3;

  static bool may_slide_off(const typename System::Scene& scene);  // two polygons may meet

  void close(Step& step) override;
  /// The one of the closed contacts k and k + 1 that only slides off an edge; none: the number of closed contacts.
  static std::size_t slides_off(const Step& step, std::size_t k);

  bool polygons_;
};
extern template class MoreauJeanOf<Planar>;
extern template class MoreauJeanOf<Spatial>;
using MoreauJean = MoreauJeanOf<Planar>;

}  // namespace orthant
