// core/scenes/motion.h — what the exact answer of a scene with one coordinate is told as.
#pragma once

namespace orthant {

inline constexpr double kGravity = 9.81;  // [m/s²]

struct Motion {
  double x = 0, v = 0;  // [m], [m/s], or [rad], [rad/s]
};

}  // namespace orthant
