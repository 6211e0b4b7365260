// core/lcp/judge/certify_sums.h — row sums and rounding limits that the files of the judge share.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant::detail {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kLeastNormal = std::numeric_limits<double>::min();
constexpr double kProducts = 1e-290;  // a sum below it may have lost terms that are smaller than any double
constexpr long double kRounding = std::numeric_limits<long double>::epsilon() / 2;

/// z_i exactly at a finite bound.
inline bool on_bound(double z, double lo, double hi) { return (z == lo || z == hi) && std::abs(z) < kInf; }

/// w ← A z + b, size ← |A| |z| + |b|; a Delassus operator is bounded through its factors, as it is applied.
void sum_rows(const Matrix& A, const Vector& b, const Vector& z, Vector& w, Vector& size, Vector& inner,
              Vector& inner_size);

/// max_j |A_ji| for all i. Delassus: |A_ji| ≤ √(A_ii A_jj) ≤ √(A_ii max A_jj), at least the column's norm.
void largest_of_columns(const Matrix& A, Vector& d);

}  // namespace orthant::detail
