// core/scenes/sphere_bounce.h — oblique impact of a ball on a rough floor, and its velocities afterwards.
//
//   Before: v = (v_x, −v_y), no spin; J = k m R². Normal impulse (1 + e) m v_y; the tangential one stops the slip,
//   which takes m |v_x| k/(1 + k), or is μ (1 + e) m v_y where that is less. By Newton's law and by Poisson's alike:
//   the normal and the tangential direction do not couple.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

namespace orthant {

struct SphereBounce {
  double mu = 0.5, e = 0.8;
  double vx = 3, vy = 4;        // [m/s] v_y > 0: downwards
  double inertia_factor = 0.4;  // k
  Restitution restitution = Restitution::newton;

  template <class V> void visit(V&& v) {
    v("mu", mu, 0.0, 1e6), v("e", e, 0.0, 1.0), v("vx", vx, -1e3, 1e3), v("vy", vy, 1e-3, 1e3);
    v("inertia_factor", inertia_factor, 1e-3, 1.0), v("restitution", restitution, kRestitutionNames);
  }

  struct Velocities {
    double vx = 0, vy = 0, omega = 0;  // [m/s], [rad/s] as a body's; the radius is 1 m
  };
  double impact_time() const { return 0.125 / vy; }  // [s]
  Velocities after() const;
};

Scene sphere_bounce(const SphereBounce& p = {});

}  // namespace orthant
