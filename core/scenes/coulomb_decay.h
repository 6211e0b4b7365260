// core/scenes/coulomb_decay.h — Coulomb decay: free oscillation of a block with a spring on a rough floor, and its
// exact end.
//
//   m ẍ + k x = −μ m g sgn ẋ. With x_k = μ m g / k, each half swing of π/ω is a cosine about ± x_k and loses 2 x_k of
//   amplitude; the block stops permanently at its first turning point with |x| ≤ x_k.
//   Defaults: k = m = 1, μ m g = 0.7, from 10: turning points 10, −8.6, 7.2, −5.8, 4.4, −3, 1.6, −0.2 (rest).
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct CoulombDecay {
  double mass = 1, stiffness = 1, g = 1;  // [kg], [N/m], [m/s²]
  double mu = 0.7, start = 10;            // [m], at rest

  template <class V> void visit(V&& v) {
    v("mass", mass, 1e-6, 1e6), v("stiffness", stiffness, 1e-6, 1e6), v("g", g, 1e-6, 1e6);
    v("mu", mu, 0.0, 1e6), v("start", start, -1e6, 1e6);
  }

  double half_swing() const;  // [s] π/ω
  int half_swings() const;    // until rest; mu > 0
  Motion at(double t) const;
};

Scene coulomb_decay(const CoulombDecay& p = {});

}  // namespace orthant
