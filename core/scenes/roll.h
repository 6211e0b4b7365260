// core/scenes/roll.h — rolling: a ball or disc slides, then rolls, on the level or down a slope; exact motion.
//
//   J = k m R² (k = 2/5 sphere, 1/2 disc), start speed v₀ ≥ 0 down the slope without spin. Slip u = v − R w, w the spin
//   in the sense of rolling down. While u > 0:  v̇ = g (sin α − μ cos α),  R ẇ = μ g cos α / k.
//   Slip ends at t_r = v₀ / (μ g cos α (1 + 1/k) − g sin α), and rolling lasts: v̇ = g sin α / (1 + k), if and only if
//   μ ≥ tan α k/(1 + k); else it slides permanently.
// Drawn with the slope along x (downwards) and gravity turned.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct Roll {
  double mu = 0.2, speed = 5;   // v₀ ≥ 0 [m/s]
  double inertia_factor = 0.4;  // k
  double slope = 0;             // [rad] α
  double radius = 1, g = kGravity;

  template <class V> void visit(V&& v) {
    v("mu", mu, 0.0, 1e6), v("speed", speed, 0.0, 1e6), v("inertia_factor", inertia_factor, 1e-3, 1.0);
    v("slope", slope, 0.0, 1.5), v("radius", radius, 1e-3, 1e3);
  }

  double rolling_time() const;   // [s] t_r; infinite when it slides for ever
  Motion at(double t) const;     // down the slope [m, m/s]
  double omega(double t) const;  // [rad/s] as a body's: < 0 when it rolls down
};

Scene roll(const Roll& p = {});

}  // namespace orthant
