// core/mechanics/planar/contact_law.h — contact law: friction and restitution of every contact.
#pragma once

#include <orthant/core/mechanics/planar/geometry.h>

#include <cmath>

namespace orthant {

inline constexpr double kStickSpeed = 1e-9;  // [m/s] a contact whose slip |γ_T| is no larger sticks, times law.unit

/// Further data of contacts in space. Vectors are given in b's frame.
struct SurfaceLaw {
  double rolling = 0, spinning = 0;  // [m] ≥ 0: moments across and along the normal of up to these times its impulse
  double mu_across = 0;              // ≥ 0: friction coefficient square to `direction`; 0: mu, as in all directions
  Vector3d direction{0, 0, 0};       // that mu is for; zero: any
  Vector3d velocity{0, 0, 0};        // [m/s] of b's surface against b: velocity + omega × (P − centre)
  Vector3d omega{0, 0, 0}, centre{0, 0, 0};  // [rad/s], [m]

  bool turns() const { return rolling > 0 || spinning > 0; }
  bool moves() const { return !velocity.isZero(0) || !omega.isZero(0); }
  bool orthotropic() const { return mu_across > 0; }
};

/// Coulomb friction and Newton restitution: ξ = γ⁺ + e γ⁻ in the normal and in the tangential direction. The slip γ_T
/// is taken against b's surface, which may move along itself (a belt): γ_T = rate of the tangent row − belt.
struct ContactLaw {
  double mu = 0;         // friction coefficient ≥ 0, of a contact that slides; 0: no friction rows at all
  double e = 0;          // normal restitution in [0, 1]
  double e_t = 0;        // tangential restitution in [−1, 1]
  double mu_static = 0;  // ≥ mu, of a contact that sticks; 0: the same as mu
  double belt = 0;       // [m/s] speed of b's surface against b, along the tangent; in the plane
  SurfaceLaw surface{};  // in space
  double unit = 1;       // of limits of speeds: SystemOf::length_unit(), of angles 1; set by System

  bool frictional() const { return mu > 0 || mu_static > 0; }
  /// The coefficient that bounds friction where the slip is γ_T [m/s].
  double mu_at(double slip) const { return mu_static > mu && std::abs(slip) <= kStickSpeed * unit ? mu_static : mu; }
};

/// Kinematics of a closed contact. The normal points from b to a; the tangent is t = −perp(n).
template <class Space> struct ContactRowsOf;
template <> struct ContactRowsOf<Planar> {
  Row normal, tangent;  // rates of the gap and of slip [m/s]
};
using ContactRows = ContactRowsOf<Planar>;
struct ContactBias {
  double normal = 0, tangent = 0;  // d/dt of the two rates at zero acceleration [m/s²]
};

/// Numbers of the tangential directions, and the verbs on them that code for both dimensions uses.
template <class Space> struct TangentOf;
template <> struct TangentOf<Planar> { using type = double; };
template <class Space> using Tangent = typename TangentOf<Space>::type;

/// J_T v [m/s]; its size; of the slip γ_T against b's surface the coefficient that bounds friction.
inline double slip_rate(const ContactRows& rows, const double* v) { return apply(rows.tangent, v); }
inline double size_of(double slip) { return std::abs(slip); }
inline double mu_at(const ContactLaw& law, double slip) { return law.mu_at(slip); }
inline double inner(double one, double other) { return one * other; }
/// The motion of b's surface along the tangent.
inline double belt_of(const ContactLaw& law, const ContactRows& /*rows*/) { return law.belt; }
/// Tangent row i; its number.
inline const Row& row_of_tangent(const ContactRows& rows, std::size_t /*i*/) { return rows.tangent; }
inline double tangent_part(double slip, std::size_t /*i*/) { return slip; }

inline Vector2d tangent_of(const Vector2d& n) { return {n.y(), -n.x()}; }

}  // namespace orthant
