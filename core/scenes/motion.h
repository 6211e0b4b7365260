// core/scenes/motion.h — exact motion (position and velocity) of a one-coordinate scene.
#pragma once

namespace orthant {

inline constexpr double kGravity = 9.81;  // [m/s²]

struct Motion {
  double x = 0, v = 0;  // [m], [m/s], or [rad], [rad/s]
};

}  // namespace orthant
