// core/scenes/pendulum.h — pendulum: a point mass on a massless rod, released at rest; exact motion.
//
//   θ̈ = −ω² sin θ, ω² = g / L, θ from downward;  with k = sin(θ₀/2):
//     sin(θ/2) = k sn(K(k) + ω t, k),   period 4 K(k) / ω = 2π / (ω agm(1, cos(θ₀/2))).
//   The body is tied by a link at its centre: it never turns, so its inertia plays no part.
// Source: Abramowitz & Stegun (1964), 16 and 17.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct Pendulum {
  double angle = 3;     // [rad] θ₀ in (−π, π), from downward, counter-clockwise
  double length = 1;    // [m]
  double mass = 1;      // [kg]
  double g = kGravity;  // [m/s²]

  template <class V> void visit(V&& v) {
    v("angle", angle, -3.14159, 3.14159), v("length", length, 1e-6, 1e6), v("mass", mass, 1e-6, 1e6);
  }

  double period() const;      // [s]
  Motion at(double t) const;  // θ, θ̇ [rad, rad/s]
};

/// The support is the origin; the mass is at L (sin θ, −cos θ).
Scene pendulum(const Pendulum& p = {});

}  // namespace orthant
