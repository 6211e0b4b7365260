// experiments/studies/motion_storm/closed_terms.h — rows of joints and closed contacts at a state, as dense vectors.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

namespace orthant::motion_storm {

/// Contacts count as closed up to `gap` [m].
Terms closed_terms(const System& system, const State& x, double gap);

Eigen::VectorXd dense(const Row& row, Eigen::Index dof);

}  // namespace orthant::motion_storm
