// integrators/reactions.h — reaction forces of joints: their means between two records, from the balance of momentum.
//
//   Gᵀ Λ = M (v₁ − v₀) − h f − Σ Wᵀ P,   least squares in the metric M⁻¹;  force on a body: its part of Gᵀ Λ / h
// f (weight, loads, springs, gyroscopic moments), G and the contacts' rows W are those of the middle between the two
// records, the impulses P those of contacts and dry frictions that the integrator reports. So the same balance serves
// every integrator. The error is O(h²) while nothing strikes, and O(h) of an impact's share where bodies turn.
// Redundant joints share the load in a way that rigid bodies do not determine: theirs is the least one.
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/simulate.h>

namespace orthant {

template <class Space> struct ReactionOf {
  static constexpr std::size_t kTurns = Space::kVelocities - Space::kTranslations;
  std::array<double, Space::kTranslations> force{};  // [N] in the world
  std::array<double, kTurns> moment{};               // [N m] in the world, about the joint's point on the second body
};

template <class Space> class ReactionsOf {
 public:
  explicit ReactionsOf(const SystemOf<Space>& system);

  /// The next record. Of each joint of the scene what its first body exerts on its second one, or the reverse of what
  /// the second exerts on the first where the second is the ground; about that body's centre where a joint has no
  /// point. Zero in the first record; NaN where the joints' rows are not finite.
  const std::vector<ReactionOf<Space>>& next(const RunSampleOf<Space>& moment);

 private:
  void gather(const RunSampleOf<Space>& moment, double h);

  const SystemOf<Space>& system_;
  TermsOf<Space> terms_;
  BasicSystemOf<Space> basic_;
  State last_;
  Eigen::VectorXd q_, v_, missing_, none_, x_, lambda_;
  std::vector<ReactionOf<Space>> all_;
};
extern template class ReactionsOf<Planar>;
extern template class ReactionsOf<Spatial>;

}  // namespace orthant
