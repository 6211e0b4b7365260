// solvers/linear_algebra/dense_lu.h — dense LU factorization P A Q = L U, in place; identifies dependent columns.
//
//   Columns in the order given, the largest entry left as pivot (partial pivoting). A column whose entries left are all
//   ≤ `zero` depends on those before it: it moves to the end. With rank r the columns column(r), …, column(m − 1)
//   depend on the others; were they the unit vectors of the rows row(r), …, row(m − 1), the matrix would be regular.
//   Left-looking: a column at a time in panels of 128, then in matrix products, cut into tiles small enough for the
//   stack, so that nothing is allocated once the largest size has been seen.   m³/3 multiplications; a solve m².
//   Entries should be scaled to at most about 1, or `zero` means nothing.
//   Source: Golub & Van Loan, Matrix Computations (4th ed., 2013), ch. 3.2, 3.4.
#pragma once

#include <orthant/core/support/reusable.h>
#include <orthant/solvers/budget.h>
#include <orthant/solvers/linear_algebra/kernels.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace orthant {

template <class T, Eigen::Index kMost = Eigen::Dynamic> class DenseLu {  // reuse it
 public:
  using Index = Eigen::Index;
  using Dense = Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>;
  using Column = Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, 1>>;

  /// Room for m × m entries, column after column, whatever they are; to be filled before factorize().
  T* reset(Index m) {
    m_ = m;
    if (u(m * m) > storage_.size()) storage_.resize(u(m * m));
    if (u(m) > row_.size()) row_.resize(u(m)), column_.resize(u(m)), scratch_.resize(u(m));
    return storage_.data();
  }

  /// The rank found; −1 when the budget, null: none, was over before the end.
  Index factorize(T zero, const Budget* budget = nullptr) {
    using std::abs;
    for (Index i = 0; i < m_; ++i) row_[u(i)] = column_[u(i)] = i;
    Dense A(storage_.data(), m_, m_);
    Index end = m_;  // columns from here on are known to depend on the others
    for (Index k0 = 0; k0 < end; k0 += kPanel) {
      const Index k1 = std::min(k0 + kPanel, m_);
      bring(A, k0, k0, k1);
      for (Index k = k0; k < std::min(k1, end);) {
        if (k % kAsked == kAsked - 1 && budget != nullptr && budget->exhausted()) return -1;
        eliminate(A.col(k).data(), k0, k);
        const T* const column = A.col(k).data();
        Index p = k;
        for (Index i = k + 1; i < m_; ++i)
          if (abs(column[i]) > abs(column[p])) p = i;
        if (!(abs(column[p]) > zero)) {
          if (--end == k) break;
          A.col(k).swap(A.col(end));
          std::swap(column_[u(k)], column_[u(end)]);
          if (end >= k1) bring(A, k0, k, k + 1);
          continue;
        }
        if (p != k) {
          for (Index j = 0; j < m_; ++j) std::swap(A(k, j), A(p, j));
          std::swap(row_[u(k)], row_[u(p)]);
        }
        T* const below = A.col(k).data();
        for (Index i = k + 1; i < m_; ++i) below[i] /= below[k];
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

  /// x ← A⁻¹ x, m numbers; for full rank.
  void solve(T* x) { solve(x, m_); }
  /// The same with the first `rank` columns alone, 0 for the others: a solution where there is one.
  void solve(T* x, Index rank) {
    const Dense A(storage_.data(), m_, m_);
    Column y(scratch_.data(), m_);
    for (Index k = 0; k < m_; ++k) y[k] = x[row_[u(k)]];
    eliminate(y.data(), 0, rank);
    y.tail(m_ - rank).setZero();
    for (Index k = rank - 1; k >= 0; --k) {
      y[k] /= A(k, k);
      if (y[k] != T(0)) subtract(y.data(), y[k], A.col(k).data(), k);
    }
    for (Index k = 0; k < m_; ++k) x[column_[u(k)]] = y[k];
  }
  /// x ← A⁻ᵀ x, m numbers; for full rank.
  void solve_transposed(T* x) {
    const Dense A(storage_.data(), m_, m_);
    Column y(scratch_.data(), m_);
    for (Index k = 0; k < m_; ++k) y[k] = x[column_[u(k)]];
    A.template triangularView<Eigen::Upper>().transpose().solveInPlace(y);
    A.template triangularView<Eigen::UnitLower>().transpose().solveInPlace(y);
    for (Index k = 0; k < m_; ++k) x[row_[u(k)]] = y[k];
  }

 private:
  static constexpr Index kPanel = 128, kTile = 128;
  static constexpr Index kFew = 8;     // entries for which a call costs more than the loop
  static constexpr Index kAsked = 16;  // columns between two questions to the budget
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
  // The pivots [k0, k) applied to the column x, four at a time.
  void eliminate(T* x, Index k0, Index k) const {
    const auto column = [this](Index s) { return storage_.data() + s * m_; };
    Index s = k0;
    if constexpr (std::is_same_v<T, double>)
      for (; m_ > kFew && s + 4 <= k; s += 4) {
        for (Index r = 1; r < 4; ++r)
          for (Index c = 0; c < r; ++c) x[s + r] -= x[s + c] * column(s + c)[s + r];
        if (x[s] == 0 && x[s + 1] == 0 && x[s + 2] == 0 && x[s + 3] == 0) continue;
        detail::subtract_four(x + s + 4, x + s, column(s) + s + 4, m_, m_ - s - 4);
      }
    for (; s < k; ++s)
      if (x[s] != 0) subtract(x + s + 1, x[s], column(s) + s + 1, m_ - s - 1);
  }
  static void subtract(T* x, T f, const T* column, Index size) {
    if constexpr (std::is_same_v<T, double>)
      if (size > kFew) return detail::subtract(x, f, column, size);
    for (Index i = 0; i < size; ++i) x[i] -= f * column[i];
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

/// The same for at most N rows, N known at compile time: no heap, and bit for bit the pivots, dependent columns and
/// solutions of the other.
template <Eigen::Index N>
  requires(N > 0)
class DenseLu<double, N> {
 public:
  using Index = Eigen::Index;

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
