// solvers/active_set/fischer_burmeister.h — Fischer-Burmeister function φ = √(a² + b²) − a − b; 0 iff a, b ≥ 0, ab = 0.
//
//   ½ Σ φ² over the rows of a complementarity problem is smooth, although φ is not: a merit function.
//   Boxes: φ(a, φ(b', −w)) with the distances a, b' to the two bounds.
//   Sources: Fischer, Optimization 24 (1992); Billups, PhD thesis, Univ. of Wisconsin (1995).
#pragma once

#include <orthant/core/lcp/problem.h>

#include <cmath>

namespace orthant::detail {

struct Slope {
  double value, da, db;
};

/// φ and an element of its generalized gradient; at the kink the one of direction (1, 1).
inline Slope fischer_burmeister(double a, double b) {
  const double r = std::hypot(a, b);
  if (r == 0) return {0, std::sqrt(0.5) - 1, std::sqrt(0.5) - 1};
  // r − a − b loses digits where one is large and positive: −2ab/(r + a + b) is the same, without the loss.
  const double value = a + b > 0 ? -2 * a * b / (r + a + b) : r - a - b;
  return {value, a / r - 1, b / r - 1};
}

/// Φ_i of a row with bounds lo, hi, z measured in units d, with its slopes in z_i and w_i.
inline Slope complementarity_row(double d, double z, double w, double lo, double hi) {
  if (lo == -kInf && hi == kInf) return {-w, 0, -1};
  if (hi == kInf) {
    const Slope s = fischer_burmeister(d * (z - lo), w);
    return {s.value, s.da * d, s.db};
  }
  const Slope inner = fischer_burmeister(d * (hi - z), -w);
  if (lo == -kInf) return {-inner.value, inner.da * d, inner.db};
  const Slope outer = fischer_burmeister(d * (z - lo), inner.value);
  return {outer.value, outer.da * d - outer.db * inner.da * d, -outer.db * inner.db};
}

}  // namespace orthant::detail
