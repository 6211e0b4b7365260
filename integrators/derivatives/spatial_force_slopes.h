// integrators/derivatives/spatial_force_slopes.h — stiffness and damping of springs, drag and loads in space, in a
// step's equations.
//
//   r = τ Σ (tension rowᵀ) + Σ (weight_k k + weight_c c) rowᵀ (row · change) − τ loads,   tension at (q, v), change
//   w − v
// as in force_slopes.h, by changes of poses (spatial_row_slope.h) and by v at a fixed w. All slopes are differences,
// element by element; c of drag depends on v.
#pragma once

#include <orthant/integrators/derivatives/force_slopes.h>
#include <orthant/integrators/derivatives/spatial_row_slope.h>

namespace orthant {

/// Appends the entries of ṙ. terms: poses; at is moved and put back.
void append_force_slopes(const SystemOf<Spatial>& system, TermsOf<Spatial>& terms, const ForceShare& share,
                         const Eigen::VectorXd& v, const Eigen::VectorXd& w, std::vector<Slope>& by_pose,
                         std::vector<Slope>& by_velocity);

/// Appends the part of a parameter in r.
void append_force_parts(const ParameterChangeOf<Spatial>& parameter, const SystemOf<Spatial>& system,
                        const TermsOf<Spatial>& terms, const ForceShare& share, const Eigen::VectorXd& v,
                        const Eigen::VectorXd& w, SparsePart& part);

/// Appends Σ (weight_k k + weight_c c) rowᵀ row: what the springs add to M.
void append_added_mass(const SystemOf<Spatial>& system, const TermsOf<Spatial>& terms, const ForceShare& share,
                       std::vector<Slope>& added);

}  // namespace orthant
