// experiments/studies/motion_storm/spatial_measure.h — gaps, joint residuals and energy of recorded states in space,
// without the library's contacts and joints: only their fields are shared.
//
//   Gap of two convex shapes: cores (points, segments, polytopes) less their radii. Point to polytope: the largest
//   distance beyond a face where that is negative, else the distance to the nearest triangle of its corners. Segment to
//   polytope, segment to segment: the least over the segment, by golden section, as the distance to a convex set is
//   convex. Two polytopes: the largest, over the normals of faces and the products of any two differences of corners,
//   of the gap along that direction. Rims: 256 points of the circle, the best one refined.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

#include <utility>
#include <vector>

namespace orthant::motion_storm {

class SpatialMeasure {
 public:
  explicit SpatialMeasure(const spatial::Scene& scene);

  /// [m, rad] < 0: inside each other.
  double gap(const spatial::Contact& contact, const Eigen::VectorXd& q) const;
  double gap(const spatial::Shape& a, const spatial::Shape& b, const Eigen::VectorXd& q) const;
  /// [m, rad] the largest entry of the residual.
  double residual(const spatial::Joint& joint, double t, const Eigen::VectorXd& q) const;
  double kinetic(const Eigen::VectorXd& v) const;    // [J]
  double potential(const Eigen::VectorXd& q) const;  // [J] of gravity and springs, less the work of constant forces
  double reach(BodyId body) const;  // [m] farthest point of contacts and joints; at least the radius of gyration
  double width(const spatial::Contact& contact) const;  // [m] of the thinner of two shapes; infinity: half-planes
  double width(const spatial::Shape& a, const spatial::Shape& b) const;
  std::pair<BodyId, BodyId> pair(const spatial::Contact& contact) const;
  double least_inertia(BodyId body) const;  // [kg m²]

 private:
  const spatial::Scene& scene_;
  Eigen::VectorXd mass_;                  // 6 a body: m, m, m, J1, J2, J3
  std::vector<Eigen::Matrix3d> to_axes_;  // of each body: its frame → principal axes
};

}  // namespace orthant::motion_storm
