// core/scenes/incline.h — incline: a block on a slope with a start velocity up (> 0) or down; exact motion.
//
//   Drawn with the slope along x and gravity turned, so that "on the slope" is y = 0 to the last bit. It slides with
//   g (sin α ± μ cos α) downwards (+: upwards moving), and once stopped it stays if and only if μ_s ≥ tan α.
//   The block is a point for contact purposes: it cannot topple.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

#include <numbers>

namespace orthant {

struct Incline {
  double slope = std::numbers::pi / 6;  // [rad] α
  double mu = 0.5, mu_static = 0;       // mu_static 0: the same as mu
  double speed = 2;                     // [m/s] at the start, > 0 upwards
  double g = kGravity;                  // [m/s²]

  template <class V> void visit(V&& v) {
    v("slope", slope, 0.0, 1.5), v("mu", mu, 0.0, 1e6), v("mu_static", mu_static, 0.0, 1e6);
    v("speed", speed, -1e6, 1e6);
  }

  double stop_time() const;   // [s] 0 when it starts at rest, infinite when it never stops
  Motion at(double t) const;  // along the slope, > 0 upwards
};

Scene incline(const Incline& p = {});

}  // namespace orthant
