// experiments/studies/motion_storm/twin.h — metamorphic twins: a scene mirrored, turned, moved, in other units.
//
//   World points:  x' = λ (R(φ) D x + d),  D = diag(m, 1);  angles  θ' = m θ + φ;  t' = τ t;  masses times κ.
//   Points in bodies:  p' = λ D p.  m = −1: mirrored, then tangents turn round: a belt's speed changes its sign.
#pragma once

#include <orthant/core/mechanics/dynamics/state.h>
#include <orthant/core/mechanics/scene/scene.h>

#include <string_view>

namespace orthant::motion_storm {

struct Twin {
  std::string_view name;
  double m = 1, phi = 0;                  // 1 or −1; [rad]
  Vector2d d{0, 0};                       // [m]
  double lambda = 1, kappa = 1, tau = 1;  // units; powers of two lose no digits
  bool reversed = false;                  // bodies, joints, contacts, springs, loads in the opposite order
  double nudge = 0;  // masses, gravity and velocities off by about this part, places [m] by a tenth: for conditioning
};

Scene twin_of(const Scene& scene, const Twin& twin);

/// Coordinates of the original that belong to coordinates of the twin.
Eigen::VectorXd back(const Twin& twin, const Eigen::VectorXd& q);

}  // namespace orthant::motion_storm
