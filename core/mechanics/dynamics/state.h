// core/mechanics/dynamics/state.h — state: time, coordinates and velocities of all bodies.
#pragma once

#include <Eigen/Core>

namespace orthant {

struct State {
  double t = 0;       // [s]
  Eigen::VectorXd q;  // a block per body (blocks.h): x, y [m], θ [rad]
  Eigen::VectorXd v;  // a block per body (blocks.h): ẋ, ẏ [m/s], ω [rad/s]
};

}  // namespace orthant
