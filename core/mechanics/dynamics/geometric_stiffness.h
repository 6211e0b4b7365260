// core/mechanics/dynamics/geometric_stiffness.h — geometric stiffness of light bodies at loaded joints: taut chains.
//
//   K = −∂(Gᵀ λ)/∂q at fixed λ. A link of length l under the tension T swings at ω² = K/J = T l/J: the lighter it is
//   next to what it carries, the faster. Schemes that take G where a step begins are stable for ω h < 2 only. They so
//   take M + h² K for M where ω h > 1, which changes the motion by O(h²): a swing a⁺ = −ω² q has the trace
//   2 − ω²h²/(1 + c ω²h²) with M + c h² K, the determinant 1: stable for every h from c = ¼ on, there at the bound;
//   c = 1 keeps the trace above 1, far from the bound, where changes of K would feed the swing.
//     pin        the force F that it puts on a body at r from its centre:  K_θθ = r · F, exact
//     distance   tension over length across it, besides:  a diagonal above −λ/L e eᵀ, e the row across
//   Only the diagonal, and only its positive part, so that M̂ stays diagonal and no less than M. Rails have none here.
// A body swings at no more than ω² = K_ii/M_ii, as joints only add inertia: below ω² h² = 1 nothing is changed. Above,
// the fastest swing that the joints allow decides, by a few steps of the power method.
// Source: Bathe, Finite Element Procedures (1996), 6.6 (K); Hairer, Lubich & Wanner (2006), XIII (step sizes).
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>

namespace orthant {

class GeometricStiffness {
 public:
  explicit GeometricStiffness(const System& system);

  /// Whether the scene may need it: bodies that are light next to those which joints connect them with, or forces from
  /// outside on such. Else no joint is so loaded that steps short enough for the motion are not short enough for K.
  bool possible() const { return possible_; }

  /// weight · max(K_ii, 0) for the joints' forces of impulses λ over `duration` [s]: raises `added` (dof) to it where
  /// that is
  /// larger. terms: poses and G. Returns whether some entry is more than `share` of M_ii.
  bool raise(const Terms& terms, const double* lambda, double duration, double weight, double share,
             Eigen::VectorXd& added) const;

  /// Whether the largest eigenvalue of B A, B the inverse of `basic` with its joints and A = diag(added), is more
  /// than `bound`.
  bool swings(const BasicSystem& basic, const Eigen::VectorXd& added, double bound) const;

 private:
  const System& system_;
  bool possible_ = false;
  mutable Eigen::VectorXd K_, x_, force_, zero_, lambda_;
};

}  // namespace orthant
