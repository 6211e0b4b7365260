// experiments/studies/exact_cases/case_groups.h — groups of planar cases, by their numbers; and parts that they share.
#pragma once

#include "experiments/studies/exact_cases/exact_case.h"

#include <cmath>
#include <vector>

namespace orthant {

/// Coordinates of body 0.
inline constexpr Index kX = 0, kY = 1, kTheta = 2;

/// |q_k − x*(t)| of a scene whose exact motion is at(t).
template <class Scenario> auto along(const Scenario& p, Index k) {
  return [p, k](const RunSample& m) { return std::abs(m.state.q[k] - p.at(m.state.t).x); };
}

void ball_cases(std::vector<ExactCase>& all);             // B1, B2
void friction_cases(std::vector<ExactCase>& all);         // B3, B4
void rolling_cases(std::vector<ExactCase>& all);          // B5
void painleve_cases(std::vector<ExactCase>& all);         // B6
void rocking_cases(std::vector<ExactCase>& all);          // B7
void impact_cases(std::vector<ExactCase>& all);           // B8, B9
void driven_cases(std::vector<ExactCase>& all);           // B10
void rest_cases(std::vector<ExactCase>& all);             // B11, B12, B20
void arch_cases(std::vector<ExactCase>& all);             // B13
void thinnest_arch_cases(std::vector<ExactCase>& all);    // B13, the threshold
void impact_law_cases(std::vector<ExactCase>& all);       // C3
void equivalent_cases(std::vector<ExactCase>& all);       // C4, C5, C7
void solver_cases(std::vector<ExactCase>& all);           // C6
void linkage_cases(std::vector<ExactCase>& all);          // B14, B15
void slanting_impact_cases(std::vector<ExactCase>& all);  // B17, B18
void slider_crank_cases(std::vector<ExactCase>& all);     // SC

}  // namespace orthant
