// integrators/derivatives/force_slopes.h — stiffness and damping matrices of springs and loads in a step's equations.
//
//   r = τ Σ (tension rowᵀ) + Σ (weight_k k + weight_c c) rowᵀ (row · change) − τ loads,   tension at (q, v)
//   ṙ by q̇ and v̇, as sparse entries; by a parameter, as a part. Without damping of the velocities' own change:
//   v̇ at a fixed v + change, so change˙ = −v̇.
#pragma once

#include <orthant/integrators/derivatives/parameter_change.h>
#include <orthant/integrators/derivatives/row_slope.h>

#include <utility>
#include <vector>

namespace orthant {

/// A parameter's part in some equations: place and derivative.
using SparsePart = std::vector<std::pair<Eigen::Index, double>>;

struct ForceShare {
  double duration = 0;                              // τ [s]
  double stiffness_weight = 0, damping_weight = 0;  // [s²], [s]
};

/// Appends the entries of ṙ, from the place `out` on. terms: poses, springs and G evaluated; at is moved and put back.
void append_force_slopes(const System& system, Terms& terms, const ForceShare& share, const Eigen::VectorXd& v,
                         const Eigen::VectorXd& change, Eigen::Index out, std::vector<Slope>& by_pose,
                         std::vector<Slope>& by_velocity);

/// Appends the part of a parameter in r: weights, springs and loads.
void append_force_parts(const ParameterChange& parameter, const System& system, const Terms& terms,
                        const ForceShare& share, const Eigen::VectorXd& v, const Eigen::VectorXd& change,
                        Eigen::Index out, SparsePart& part);

}  // namespace orthant
