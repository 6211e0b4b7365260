// core/mechanics/dynamics/state.h — state: time, coordinates and velocities of all bodies.
#pragma once

#include <Eigen/Core>

namespace orthant {

struct State {
  double t = 0;       // [s]
  Eigen::VectorXd q;  // 3 per body: x, y [m], θ [rad]
  Eigen::VectorXd v;  // 3 per body: ẋ, ẏ [m/s], ω [rad/s]
};

}  // namespace orthant
