// integrators/derivatives/shared_friction.h — friction without a slip that several contacts hold together.
//
//   Contacts of one body on one plane have the same tangents (the corners of a box): of their forces z, J_Tᵀ z alone
//   acts. A solver may answer with two of them at their bounds in opposite senses, where a share inside the bounds has
//   the same motion. The derivative at those bounds would let both contacts slide, though none does. Here z is
//     z = B^½ (J_Tᵀ B^½)⁺ J_Tᵀ z⁰,   B = diag(bounds),                                                             (1)
//   the z of the same J_Tᵀ z with the least Σ z_i² / b_i: of equal tangents each in proportion to its bound. Where it
//   is inside all bounds the contacts stick on both sides of a change of the data. Else friction is weakly active.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/lcp/solution.h>
#include <orthant/core/mechanics/rows.h>

#include <Eigen/Core>

#include <span>
#include <vector>

namespace orthant {

/// Nearer to its bound, relative to it, friction is at it.
inline constexpr double kAtFrictionBound = 1e-9;

/// (1): acts = J_Tᵀ, bounds > 0. False: not all are inside their bounds so; z is as it was.
bool share_friction(const Eigen::MatrixXd& acts, const Eigen::VectorXd& bounds, Eigen::VectorXd& z);

/// Where friction of `problem` is at its bound, but does not slip: (1) for all friction that does not slip. rows: J of
/// the problem's rows; stick: the largest |w| without a slip, one a friction. True: z is changed.
bool share_friction(const Lcp& problem, std::span<const Row> rows, Eigen::Index dof, const Vector& w,
                    std::span<const double> stick, Vector& z);

}  // namespace orthant
