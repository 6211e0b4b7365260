// solvers/dense_lu.h — P A Q = L U of a dense matrix in any floating type, in place, with the dependent columns named.
//
//   Columns in the order given, the largest entry left as pivot (partial pivoting). A column whose entries left are all
//   ≤ `zero` depends on those before it: it moves to the end. With rank r the columns column(r), …, column(m − 1) depend
//   on the others; were they the unit vectors of the rows row(r), …, row(m − 1), the matrix would be regular.
//   Left-looking in panels of 32, so that the work is in matrix products; they are cut into tiles small enough for the
//   stack, so that nothing is allocated once the largest size has been seen.   m³/3 multiplications; a solve m².
//   Entries should be scaled to at most about 1, or `zero` means nothing.
//   Source: Golub & Van Loan, Matrix Computations (4th ed., 2013), ch. 3.2, 3.4.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace orthant {

template <class T> class DenseLu {  // reuse it
 public:
  using Index = Eigen::Index;
  using Dense = Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>;
  using Column = Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, 1>>;

  /// m × m zeros to be filled before factorize().
  Dense reset(Index m) {
    m_ = m;
    storage_.assign(static_cast<std::size_t>(m * m), T(0));
    return {storage_.data(), m, m};
  }

  /// The rank found; solves are for full rank only.
  Index factorize(T zero) {
    using std::abs;
    row_.resize(u(m_)), column_.resize(u(m_)), scratch_.resize(u(m_));
    for (Index i = 0; i < m_; ++i) row_[u(i)] = column_[u(i)] = i;
    Dense A(storage_.data(), m_, m_);
    Index end = m_;  // columns from here on are known to depend on the others
    for (Index k0 = 0; k0 < end; k0 += kPanel) {
      const Index k1 = std::min(k0 + kPanel, m_);
      bring(A, k0, k0, k1);
      for (Index k = k0; k < std::min(k1, end);) {
        Index p = 0;
        if (!(A.col(k).tail(m_ - k).cwiseAbs().maxCoeff(&p) > zero)) {
          if (--end == k) break;
          A.col(k).swap(A.col(end));
          std::swap(column_[u(k)], column_[u(end)]);
          if (end >= k1) {
            bring(A, k0, k, k + 1);
            apply(A, k0, k, k, k + 1);
          }
          continue;
        }
        if (p > 0) {
          A.row(k).swap(A.row(k + p));
          std::swap(row_[u(k)], row_[u(k + p)]);
        }
        const Index below = m_ - k - 1;
        A.col(k).tail(below) /= A(k, k);
        for (Index j = k + 1; j < k1; ++j)
          if (A(k, j) != T(0)) A.col(j).tail(below) -= A(k, j) * A.col(k).tail(below);
        ++k;
      }
    }
    least_ = largest_ = m_ > 0 ? abs(A(0, 0)) : T(1);
    for (Index k = 0; k < end; ++k) {
      least_ = std::min(least_, abs(A(k, k)));
      largest_ = std::max(largest_, abs(A(k, k)));
    }
    return end;
  }
  Index row(Index k) const { return row_[u(k)]; }
  Index column(Index k) const { return column_[u(k)]; }
  T least_pivot() const { return least_; }
  T largest_pivot() const { return largest_; }

  /// x ← A⁻¹ x, m numbers.
  void solve(T* x) {
    const Dense A(storage_.data(), m_, m_);
    Column y(scratch_.data(), m_);
    for (Index k = 0; k < m_; ++k) y[k] = x[row_[u(k)]];
    A.template triangularView<Eigen::UnitLower>().solveInPlace(y);
    A.template triangularView<Eigen::Upper>().solveInPlace(y);
    for (Index k = 0; k < m_; ++k) x[column_[u(k)]] = y[k];
  }
  /// x ← A⁻ᵀ x, m numbers.
  void solve_transposed(T* x) {
    const Dense A(storage_.data(), m_, m_);
    Column y(scratch_.data(), m_);
    for (Index k = 0; k < m_; ++k) y[k] = x[column_[u(k)]];
    A.template triangularView<Eigen::Upper>().transpose().solveInPlace(y);
    A.template triangularView<Eigen::UnitLower>().transpose().solveInPlace(y);
    for (Index k = 0; k < m_; ++k) x[row_[u(k)]] = y[k];
  }

 private:
  static constexpr Index kPanel = 32, kTile = 128;
  static std::size_t u(Index i) { return static_cast<std::size_t>(i); }

  // The pivots [k0, k1) applied to the columns [j0, j1).
  void apply(Dense& A, Index k0, Index k1, Index j0, Index j1) {
    const Index k = k1 - k0, j = j1 - j0;
    if (k == 0) return;
    auto top = A.block(k0, j0, k, j);
    for (Index s = 0; s < k; ++s)
      for (Index c = 0; c < j; ++c)
        if (top(s, c) != T(0)) top.col(c).tail(k - s - 1) -= top(s, c) * A.col(k0 + s).segment(k0 + s + 1, k - s - 1);
    for (Index i = k1; i < m_; i += kTile) {
      const Index rows = std::min(kTile, m_ - i);
      A.block(i, j0, rows, j).noalias() -= A.block(i, k0, rows, k) * top;
    }
  }
  // All panels before k0.
  void bring(Dense& A, Index k0, Index j0, Index j1) {
    for (Index p = 0; p < k0; p += kPanel) apply(A, p, p + kPanel, j0, j1);
  }

  Index m_ = 0;
  std::vector<T> storage_, scratch_;
  std::vector<Index> row_, column_;
  T least_ = 1, largest_ = 1;
};

}  // namespace orthant
