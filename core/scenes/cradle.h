// core/scenes/cradle.h — Newton's cradle: n equal balls in a row; the first one strikes the others; speeds afterwards.
//
//   Frictionless, no gravity, the others at rest; the first comes at v.
//   At once (gap 0, impacts = simultaneous), by Newton's law and by Poisson's alike:
//     u₁ = v (1 − (n−1) e)/n,  u₂ = … = u_n = v (1 + e)/n:   n = 3, e = 1: (−1/3, 2/3, 2/3).
//   In turn (impacts = sequential, or gaps): e = 1: the last ball takes all; else see collinear.h.
//   Both keep the momentum m v, and for e = 1 the energy: the laws differ where rigid-body mechanics gives no unique
//   answer.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

namespace orthant {

struct Cradle {
  int balls = 3;
  double e = 1, speed = 1;  // v > 0 [m/s]
  double gap = 0;           // [m] ≥ 0 between the balls at rest
  Impacts impacts = Impacts::simultaneous;
  Restitution restitution = Restitution::newton;

  template <class V> void visit(V&& v) {
    v("balls", balls, 2, 1000), v("e", e, 0.0, 1.0), v("speed", speed, 1e-3, 1e3), v("gap", gap, 0.0, 0.1);
    v("impacts", impacts, kImpactsNames), v("restitution", restitution, kRestitutionNames);
  }

  double impact_time() const { return 0.125 / speed; }  // [s] of the first impact
  std::vector<double> after() const;                    // [m/s] ball by ball; exact for gap 0 or e = 1
};

/// Bodies 0 … n − 1 from left to right, of mass 1 kg.
Scene cradle(const Cradle& p = {});

}  // namespace orthant
