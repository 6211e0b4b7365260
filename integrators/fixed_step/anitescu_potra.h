// integrators/fixed_step/anitescu_potra.h — Anitescu–Potra stepping with convex relaxed friction.
//
//   The step of stewart_trinkle.h with the friction of Cone::relaxed (formulate.h): the impulse lies in the cone, the
//   rates in its dual,  g_N/h + γ_N⁺ ≥ μ |γ_T⁺|,  so that the problem is the optimality condition of a convex quadratic
//   program: a symmetric positive semidefinite matrix, always solvable when some motion is free of penetration.
//   Its price is an artefact: a contact that slides is held open at g_N = μ h |γ_T| (that vanishes with h, and a
//   contact that sticks has Coulomb's law). So candidates are the contacts nearer than that at the end of free flight;
//   their rows are evaluated for all contacts of the scene, O(contacts) a step. With e > 0 an impact with slip rebounds
//   at e |γ_N⁻| + μ |γ_T|, for any h: restitution and relaxed friction are not compatible, take another scheme. Static
//   friction above kinetic acts on contacts that stick at the step's start, not on those that come to rest within it.
// In space the cone is a pyramid of eight edges, the first one along the slip of free flight, or, where there is none,
// along the slip that normal impulses begin: it turns with the scene, and a body that slides straight on has the
// relaxed disc's motion.
// Order 1 for e = 0, as Stewart–Trinkle.
// Source: Anitescu & Potra, Nonlinear Dynamics 14 (1997) 231-247; Anitescu & Hart, Math. Program. 101 (2004) 57-91;
// Anitescu, Math. Program. 105 (2006) 113-143.
#pragma once

#include <orthant/integrators/fixed_step/stewart_trinkle.h>

namespace orthant {

template <class Space> class AnitescuPotraOf final : public StewartTrinkleOf<Space> {
 public:
  using System = SystemOf<Space>;
  using Options = VelocitySteppingOptions;
  static constexpr std::string_view kName = "anitescu-potra";
  static constexpr Capabilities kCan{.impact_laws = false, .pyramids = false};
  explicit AnitescuPotraOf(const System& system, const Options& options = {})
      : StewartTrinkleOf<Space>(system, options, Cone::relaxed, kName, kCan) {}
};
using AnitescuPotra = AnitescuPotraOf<Planar>;

}  // namespace orthant
