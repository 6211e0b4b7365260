// experiments/studies/motion_storm/measure.h — gaps, joint residuals and energy of recorded states, without the
// library's contacts and joints: only their fields are shared.
//
//   Gap of two convex polygons: the largest, over the faces of both, of the least distance of the other's corners
//   beyond that face (separating axis). Negative: the least way out. Positive: at most their distance.
//   Gap of a disc and a polygon: distance of the centre to the boundary, negative inside, less the radius.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

#include <limits>
#include <utility>

namespace orthant::motion_storm {

class Measure {
 public:
  explicit Measure(const Scene& scene) : scene_(scene) {}

  /// [m, rad] < 0: inside each other. Of a kind it does not know: infinity.
  double gap(const Contact& contact, const Eigen::VectorXd& q) const;
  /// [m, rad] the largest entry of the residual; of a kind it does not know: 0.
  double residual(const Joint& joint, double t, const Eigen::VectorXd& q) const;
  double kinetic(const Eigen::VectorXd& v) const;    // [J]
  double potential(const Eigen::VectorXd& q) const;  // [J] of gravity and springs, less the work of constant loads
  double reach(BodyId body) const;                   // [m] farthest point of the body's contacts from its centre
  double width(const Contact& contact) const;        // [m] of the thinner of two shapes; infinity: half-planes, bounds
  std::pair<BodyId, BodyId> pair(const Contact& contact) const;

 private:
  const Scene& scene_;
};

}  // namespace orthant::motion_storm
