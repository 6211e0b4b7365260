// experiments/studies/motion_storm/spatial_twin.h — metamorphic twins in space: scenes turned, moved, in other units.
//
//   World points:  x' = λ (R x + d);  orientations  R p;  t' = τ t;  masses times κ.  Points in bodies:  p' = λ p.
#pragma once

#include "experiments/studies/motion_storm/twin.h"

#include <orthant/core/mechanics/spatial/scene.h>

#include <string_view>
#include <type_traits>

namespace orthant::motion_storm {

struct SpatialTwin {
  std::string_view name;
  Vector3d turn{0, 0, 0};                 // [rad] rotation vector of R
  Vector3d d{0, 0, 0};                    // [m]
  double lambda = 1, kappa = 1, tau = 1;  // units; powers of two lose no digits
  bool reversed = false;                  // bodies, joints, contacts, shapes, springs, loads in the opposite order
  double nudge = 0;                       // as in the plane (twin.h)
};
template <class Space> using TwinOf = std::conditional_t<kPlanar<Space>, Twin, SpatialTwin>;

spatial::Scene twin_of(const spatial::Scene& scene, const SpatialTwin& twin);

/// Coordinates of the original that belong to coordinates of the twin.
Eigen::VectorXd back(const SpatialTwin& twin, const Eigen::VectorXd& q);

}  // namespace orthant::motion_storm
