// core/mechanics/dynamics/joint_load.h — joint reaction force: its magnitude, for dry friction in the joint.
//
//   R = | Σ_r λ_r f_r |,   f_r: the force that row r of G puts on one of the two bodies for λ_r = 1   [N]
// over the rows of the joint and of its copies: pins of the same two bodies at the same points, rails of the same two
// bodies in one direction. How copies share the load is not determined, their sum is; so the friction does not depend
// on how often a joint is written. Angle rows exert no force and do not count.
// Limit: if other joints make this one redundant, R is its share by the λ of the redundant rows (basic_system.h);
// Redundancy reports such joints.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <span>
#include <vector>

namespace orthant {

/// The joint and its copies, in the order of the scene.
std::vector<int> copies_of(const Scene& scene, int joint);

/// In space the joint alone: copies are not looked for.
std::vector<int> copies_of(const spatial::Scene& scene, int joint);

template <class Space> class JointLoadOf {
 public:
  JointLoadOf(const SystemOf<Space>& system, int joint);

  /// G and λ, one entry a joint row; λ may be impulses [N s], then so is R.
  double size(std::span<const RowOf<Space>> G, const double* lambda) const;

 private:
  BodyId body_;
  std::vector<int> rows_;
};
extern template class JointLoadOf<Planar>;
extern template class JointLoadOf<Spatial>;
using JointLoad = JointLoadOf<Planar>;

}  // namespace orthant
