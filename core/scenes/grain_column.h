// core/scenes/grain_column.h — grain column: n grains fall onto the floor together; impulse and force of each level.
//
//   Equal, smooth, inelastic, touching each other and the floor, all at the speed v. They stop at once: the impulse at
//   level k = 1 … n (1: the floor) is (n − k + 1) m v, and from then on the force is (n − k + 1) m g.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct GrainColumn {
  int grains = 10;
  double speed = 1;     // [m/s] v ≥ 0, downwards
  double g = kGravity;  // [m/s²]

  template <class V> void visit(V&& v) {
    v("grains", grains, 1, 100000), v("speed", speed, 0.0, 1e3), v("g", g, 0.0, 1e3);
  }

  double force(int level) const { return (grains - level + 1) * g; }                            // [N] at rest
  double impulse(int level, double t) const { return (grains - level + 1) * (speed + g * t); }  // [N s] up to t
};

/// Body and contact k − 1 are grain and level k, of 1 kg.
Scene grain_column(const GrainColumn& p = {});

}  // namespace orthant
