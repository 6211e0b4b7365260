// experiments/studies/pile_scaling/columns.h — spheres on top of one another, at rest.
#pragma once

#include "experiments/studies/pile_scaling/pile_motion.h"

namespace orthant {

/// Prints a table: of each height the iterations of each solver, and its factorizations, from a cold start to the
/// tolerance, a relative residual.
void columns(const std::vector<int>& heights, const std::vector<std::string>& specs, double tolerance,
             const Settling& way);

}  // namespace orthant
