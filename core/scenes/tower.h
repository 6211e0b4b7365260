// core/scenes/tower.h — tower of blocks with masses in a geometric series, the heavy on the light.
//
//   Masses 1, r, r², … kg from the bottom up; at rest level k = 1 … n carries g Σ_{i ≥ k} m_i. With one contact a level
//   and r large, Gauss-Seidel's error falls by r/(1 + r) a sweep (two blocks), direct methods do not depend on the
//   ratio.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct Tower {
  int blocks = 2;
  double ratio = 1e6;   // r
  int corners = 1;      // contacts a level: 1 under the centre, 2 at the corners
  double g = kGravity;  // [m/s²]

  template <class V> void visit(V&& v) {
    v("blocks", blocks, 1, 10000), v("ratio", ratio, 1e-9, 1e9), v("corners", corners, 1, 2), v("g", g, 0.0, 1e3);
  }

  double mass(int block) const;   // [kg] block 1 … n
  double force(int level) const;  // [N] of all its contacts, 1 … n
};

/// Body k − 1 is block k; the contacts of level k are the k-th `corners` ones.
Scene tower(const Tower& p = {});

}  // namespace orthant
