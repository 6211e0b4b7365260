// solvers/linear_algebra/few_lu.h — dense LU for at most N rows, N known at compile time: no heap.
//
//   The same pivots, treatment of dependent columns and bits as DenseLu (dense_lu.h).
#pragma once

#include <orthant/core/support/reusable.h>

#include <array>
#include <cmath>
#include <utility>

namespace orthant {

template <Index N> class FewLu {
 public:
  /// Room for m × m entries, column after column, whatever they are; to be filled before factorize().
  double* reset(Index m) {
    m_ = m;
    return a_.data();
  }

  /// The rank found.
  Index factorize(double zero) {
    const Index m = m_;
    double* const a = a_.data();
    for (Index i = 0; i < m; ++i) row_[at(i)] = column_[at(i)] = i;
    Index end = m;  // columns from here on are known to depend on the others
    for (Index k = 0; k < end;) {
      double* const pivot = a + m * k;
      Index p = k;
      for (Index i = k + 1; i < m; ++i)
        if (std::abs(pivot[i]) > std::abs(pivot[p])) p = i;
      if (!(std::abs(pivot[p]) > zero)) {
        --end;
        for (Index i = 0; i < m; ++i) std::swap(pivot[i], a[m * end + i]);
        std::swap(column_[at(k)], column_[at(end)]);
        continue;
      }
      if (p != k) {
        for (Index j = 0; j < m; ++j) std::swap(a[m * j + k], a[m * j + p]);
        std::swap(row_[at(k)], row_[at(p)]);
      }
      for (Index i = k + 1; i < m; ++i) pivot[i] /= pivot[k];
      for (Index j = k + 1; j < m; ++j)
        for (Index i = k + 1; i < m; ++i) a[m * j + i] -= a[m * j + k] * pivot[i];
      ++k;
    }
    return end;
  }

  /// x ← A⁻¹ x with the first `rank` columns alone, 0 for the others: a solution where there is one.
  void solve(double* x, Index rank) const {
    const Index m = m_;
    const double* const a = a_.data();
    std::array<double, at(N)> y;
    for (Index k = 0; k < m; ++k) y[at(k)] = x[row_[at(k)]];
    for (Index k = 0; k < rank; ++k)
      for (Index i = k + 1; i < m; ++i) y[at(i)] -= y[at(k)] * a[m * k + i];
    for (Index k = rank; k < m; ++k) y[at(k)] = 0;
    for (Index k = rank - 1; k >= 0; --k) {
      y[at(k)] /= a[m * k + k];
      for (Index i = 0; i < k; ++i) y[at(i)] -= y[at(k)] * a[m * k + i];
    }
    for (Index k = 0; k < m; ++k) x[column_[at(k)]] = y[at(k)];
  }

 private:
  Index m_ = 0;
  std::array<double, at(N* N)> a_;
  std::array<Index, at(N)> row_, column_;
};

}  // namespace orthant
