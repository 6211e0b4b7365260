// core/lcp/cones/interval.h — Coulomb friction with one tangent direction: projection, residual, support function.
//
//   K_μ = {(n, t): |t| ≤ μ n}. At a given n ≥ 0 the friction t lies in [−μ n, μ n], and opposes the slip u:
//     t = clamp(t − ρ u, −μ n, μ n) for any ρ > 0.
//   Support function of {|t| ≤ μ n}: sup g t = μ n |g|.
#pragma once

#include <algorithm>
#include <cmath>

namespace orthant::interval {

/// The point of [−radius, radius] next to t.
inline double project(double radius, double t) { return std::clamp(t, -radius, radius); }

/// |t − P(t − u)|: zero where t opposes the slip u within its bounds.
inline double residual(double radius, double t, double u) { return std::abs(t - project(radius, t - u)); }

/// sup g t over |t| ≤ radius.
inline double support(double radius, double g) { return radius * std::abs(g); }

}  // namespace orthant::interval
