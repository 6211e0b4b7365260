// core/scenes/robot_arm.h — robot arm from a model in URDF (robot_arm.urdf): it sweeps a box over a rough floor.
//
//   Its base turns from 0 to `sweep` and back, φ = sweep (1 − cos ωt) / 2 with ω = π / time. Springs hold lift and
//   elbow at 1.2 and 1.6 rad, so that the hand is upright above the floor. The box stands in the way of the hand.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct RobotArm {
  double sweep = 1.2, time = 1.5;          // [rad, s]
  double edge = 0.15, mass = 2, mu = 0.4;  // [m, kg, 1] of the box; friction with floor and hand
  template <class V> void visit(V&& v) {
    v("sweep", sweep, 0.0, 2.5), v("time", time, 0.1, 1e3), v("edge", edge, 0.05, 0.25), v("mass", mass, 1e-3, 1e3);
    v("mu", mu, 0.0, 10.0);
  }
};

/// Throws std::invalid_argument in a build without an XML reader.
spatial::Scene robot_arm(const RobotArm& p = {});

}  // namespace orthant
