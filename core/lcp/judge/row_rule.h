// core/lcp/judge/row_rule.h — violation of a row and its limits, as both judges apply them: certify.h, and the
// distributed one.
#pragma once

#include <orthant/core/lcp/judge/certify_sums.h>
#include <orthant/core/lcp/judge/exact.h>
#include <orthant/core/lcp/solution.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant::detail {

constexpr double kRoundings = 20;                 // units in the last place that `rounded` may change
constexpr double kSure = 1 - 0x1p-20;             // limits are sums of doubles themselves
constexpr double kDouble = 0.505 * kEpsilon;      // error of an operation, over its result
constexpr long double kLong = 1.01L * kRounding;  // the same in long double

inline double nearest_to_zero(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? hi : 0; }

/// v_i where it is positive: how far w is on the wrong side.
///   lo = 0, hi = ∞:   z = 0, w = −2: 2.   z = 0, w = 3: −3.   z = 1, w = 3: 3.   z = −1: ∞.
template <class T> inline T wrong_by(double z, T w, double lo, double hi) {
  if (!(lo <= z && z <= hi && std::abs(z) < kInf)) return kInf;
  if (lo == hi) return -kInf;
  if (z == lo) return -w;
  if (z == hi) return w;
  return std::abs(w);
}

/// The same for an exact w. What is smaller than any double is no zero.
inline double exactly_wrong_by(const exact::Rational& w, double z, double lo, double hi) {
  const exact::Rational v = z == lo ? exact::Rational(-w) : z == hi ? w : exact::Rational(abs(w));
  const double nearest = exact::nearest(v);
  return nearest == 0 && v > 0 ? std::numeric_limits<double>::denorm_min() : nearest;
}

/// The limit of v_i for solved.   tol = 1e-10, s = 5, β = 2: 2e-10.   s = 1e-3: 1e-13.
inline double limit_of_solved(double tolerance, double s, double beta) { return tolerance * std::min(s, beta); }

/// The limit of v_i for rounded.   s = 1e9: 4.4e-6.
inline double limit_of_rounded(double s) { return kRoundings * kEpsilon * s; }

inline Miss::Against against(double z, double lo, double hi) {
  return !(lo <= z && z <= hi && std::abs(z) < kInf) ? Miss::Against::outside
         : z == lo                                   ? Miss::Against::lower
         : z == hi                                   ? Miss::Against::upper
                                                     : Miss::Against::inside;
}

}  // namespace orthant::detail
