// integrators/step/rate_targets.h — Newton's law of restitution: targets −e γ⁻ of the closed contacts' rates after a
// step.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/mechanics/dynamics/terms.h>

#include <type_traits>
#include <vector>

namespace orthant {

/// Of contacts in space; planar ones have it in their law.
struct NoBelt {
  NoBelt& operator=(double /*law's*/) { return *this; }
};

/// Targets of a closed contact's rates after the step, with its rates before and its law. [m/s]
template <class Space> struct RateTargetOf {
  double normal = 0;
  Tangent<Space> tangent{};
  Tangent<Space> slip{};            // γ_T⁻, which chooses μ
  const ContactLaw* law = nullptr;  // stays where it is until the step is done
  double approach = 0;              // γ_N⁻
  double least = -kInf;             // of `normal`, whatever the law: required by the scheme
  double plastic = kInf;            // `normal` with e = 0, where a scheme's own law says it
  // For energy_rise(): γ_T⁻ and, with the step's forces, γ_N and γ_T without contacts, see note_forces().
  Tangent<Space> slip_before{};
  double free = 0;
  Tangent<Space> free_slip{};
  [[no_unique_address]] std::conditional_t<kPlanar<Space>, NoBelt, Tangent<Space>> belt{};  // see belt_of()
};
using RateTarget = RateTargetOf<Planar>;

/// The motion of b's surface along the tangent.
template <class Space> Tangent<Space> belt_of(const RateTargetOf<Space>& w) {
  if constexpr (kPlanar<Space>)
    return w.law->belt;
  else
    return w.belt;
}

/// Newton's law: −e γ_N⁻ and −e_T γ_T⁻ (against the moving surface) of each closed contact, v before the step. `laws`:
/// the system's.
template <class Space> void newtons_law(const ContactLaws& laws, const TermsOf<Space>& terms, const Eigen::VectorXd& v,
                                        std::vector<RateTargetOf<Space>>& targets);

/// A slower approach is a contact at rest. [m/s], times law.unit
inline constexpr double kRestSpeed = 1e-9;

/// Tangential restitution is for contacts that strike: that approach faster than kRestSpeed, and than the step's forces
/// make them (free − approach). All others slip under friction alone.
template <class Space> void restrict_to_strikes(std::vector<RateTargetOf<Space>>& targets);

}  // namespace orthant
