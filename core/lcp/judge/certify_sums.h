// core/lcp/judge/certify_sums.h — row sums and rounding limits that the files of the judge share.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant::detail {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kRoundings = 20;   // residuals below this many ρ are noise
constexpr double kCoarsest = 4e-5;  // residual relative to β that rounding may excuse
constexpr double kLeastNormal = std::numeric_limits<double>::min();
constexpr double kFormed = 7e7;  // products up to which an operator's entries are formed
constexpr long double kRounding = std::numeric_limits<long double>::epsilon() / 2;

/// s above this: w is unknown. By s, not by ρ = ε s, which is no number any more where s < 1e-308.
inline double runaway(double beta) { return std::min(1e-6 / kEpsilon * (1 + beta), 1e-4 / kEpsilon * beta); }

/// z_i exactly at a finite bound.
inline bool on_bound(double z, double lo, double hi) { return (z == lo || z == hi) && std::abs(z) < kInf; }

/// w ← A z + b, size ← |A| |z| + |b|; a Delassus operator is bounded through its factors, as it is applied.
void sum_rows(const Matrix& A, const Vector& b, const Vector& z, Vector& w, Vector& size, Vector& inner,
              Vector& inner_size);

/// max_j |A_ji| for all i. Delassus: |A_ji| ≤ √(A_ii A_jj) ≤ √(A_ii max A_jj), at least the column's norm.
void largest_of_columns(const Matrix& A, Vector& d);

/// 20 η n (1 + max |A_ij|), η the least number above 0, but less than the least normal number: what underflow leaves
/// unknown of a w. d: scratch.
double lost_to_underflow(const Matrix& A, Vector& d);

}  // namespace orthant::detail
