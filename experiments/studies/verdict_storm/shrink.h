// experiments/studies/verdict_storm/shrink.h — test-case reduction: the smallest problem that still shows a fault.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <functional>

namespace orthant {

/// Rows are left out, entries become 0, ±1 or lose digits, bounds become 0 or ∞, the operator and sparse storage become
/// dense, as long as `shows` stays true; until nothing more goes. `shows(problem)` must hold at the start, and is
/// called some n² times. The same input gives the same output.
Lcp shrink(Lcp problem, const std::function<bool(const Lcp&)>& shows);

}  // namespace orthant
