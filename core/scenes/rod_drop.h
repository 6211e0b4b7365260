// core/scenes/rod_drop.h — rod drop: a slanting rod falls onto a smooth floor; velocities after the impact of one end.
//
//   Uniform rod of half-length 1 m and 1 kg at the angle θ, falling at v without turning, no gravity, no friction:
//     impulse p = (1 + e) m v / (1 + 3 cos² θ),   v_y⁺ = −v + p/m,   ω⁺ = 3 p cos θ / (m l)
//   (of the end that is ahead on the left; the other is out of reach for the scene's duration).
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

#include <numbers>

namespace orthant {

struct RodDrop {
  double angle = std::numbers::pi / 4;  // [rad] θ in (0, π/2]: the left end is the lower one
  double e = 0.5, speed = 1;            // [m/s] v > 0, downwards
  Restitution restitution = Restitution::newton;

  template <class V> void visit(V&& v) {
    v("angle", angle, 0.1, std::numbers::pi / 2), v("e", e, 0.0, 1.0), v("speed", speed, 1e-3, 1e3);
    v("restitution", restitution, kRestitutionNames);
  }

  struct Answer {
    double impulse = 0, vy = 0, omega = 0;  // [N s], [m/s], [rad/s] < 0: clockwise
  };
  double impact_time() const { return 0.01 / speed; }  // [s]
  Answer after() const;
};

Scene rod_drop(const RodDrop& p = {});

}  // namespace orthant
