// integrators/step/spatial_tunnelling.h — tunnelling detection in space: shapes that pass through each other within one
// step.
//
//   As in the plane (tunnelling.h): two shapes have passed if their gap is smaller on the way than at both ends, and
//   than 0, by 1/20 of the thinner one; or if they overlap by that at the end and the normal has turned round since
//   they met. The gap is followed along the way, no farther at a time than it is wide or than 1/16 of the thinner one.
//   The way: centres of mass go straight, bodies turn evenly about one axis, by less than half a turn.
//   Tested are sphere-sphere contacts and searched collisions. Half-spaces need no detection.
// Cost: nothing where no shapes meet; O(bodies) a step while all move less than a fifth of the thinnest shape in it.
// Limit: passages of less than that depth, on another path, or with more than half a turn a step.
#pragma once

#include <orthant/integrators/step/tunnelling.h>

namespace orthant {

class SpatialTunnellingDetector {
 public:
  explicit SpatialTunnellingDetector(const SystemOf<Spatial>& system);

  /// The first of the pairs, listed or in terms.pairs, that passed between q and q_end.
  Passage find(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const TermsOf<Spatial>& terms) {
    return collisions_.empty() ? Passage{} : look(q, q_end, terms);
  }

 private:
  Passage look(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const TermsOf<Spatial>& terms);
  bool passed(const Eigen::VectorXd& q, const spatial::Shape& a, const spatial::Shape& b, double width, double way);
  /// The point with the least gap at s ∈ [0, 1] of the way.
  spatial::TouchPoint at(const Eigen::VectorXd& q, const spatial::Shape& a, const spatial::Shape& b, double s);
  double way_of(BodyId body) const { return body < 0 ? 0 : way_[static_cast<std::size_t>(body)]; }

  const SystemOf<Spatial>& system_;
  std::vector<spatial::Collision> collisions_;  // the scene's, then one of each listed contact of two spheres
  std::vector<std::vector<double>> width_;      // of each shape [m]
  std::vector<double> reach_, way_;             // of each body: its shapes' farthest point; how far it goes [m]
  double least_ = 0;                            // [m]
  Eigen::VectorXd step_;
};

template <class Space> using TunnellingDetectorOf =
    std::conditional_t<kPlanar<Space>, TunnellingDetector, SpatialTunnellingDetector>;

}  // namespace orthant
