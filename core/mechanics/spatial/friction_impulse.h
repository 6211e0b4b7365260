// core/mechanics/spatial/friction_impulse.h — friction impulse of a contact along its unit tangents.
//
//   Orthotropic friction scales the second tangent row by s = μ'/μ (contact_rows.h): an impulse Λ of that row is s Λ
//   along the unit tangent.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>

namespace orthant {

inline Tangents along_unit_tangents(const ContactLaw& law, const Tangents& impulse) {
  return {impulse.first, law.surface.orthotropic() ? law.surface.mu_across / law.mu * impulse.second : impulse.second};
}
inline double along_unit_tangents(const ContactLaw& /*law*/, double impulse) { return impulse; }  // in the plane

}  // namespace orthant
