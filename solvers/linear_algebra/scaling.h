// solvers/linear_algebra/scaling.h — equilibration: diag(row) M diag(col) with powers of 2 brings entries together.
//
//   Powers of 2, so that scaling costs no rounding. Ones when the rows' and columns' largest entries are within 2²⁴ of
//   each other already: then scaling would only change the path.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/linear_algebra/kernels.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace orthant::detail {

/// The largest |A_ij| of each row, of a Delassus matrix A_ii; 1 where that is 0.
inline void row_sizes(const Matrix& A, Vector& size) {
  size.resize(order(A));
  size.setZero();
  if (!for_each_entry(A, [&size](Index i, Index, double a) { size[i] = std::max(size[i], std::abs(a)); }))
    diagonal(A, size);
  for (double& value : size)
    if (!(value > 0)) value = 1;
}

class Scaling {  // reuse it: the second problem of a size allocates nothing
 public:
  Vector row, col;

  void fit(const DenseMatrix& M) {
    const Index n = M.rows();
    double* const in_row = begin(n);
    for (Index j = 0; j < n; ++j) {  // a column at a time: a third of the time of entry by entry
      const double* const column = M.data() + j * n;
      for (Index i = 0; i < n; ++i) in_row[i] = std::max(in_row[i], std::abs(column[i]));
      in_row[n + j] = largest(column, n);
    }
    finish([&](const auto& use) {
      for (Index j = 0; j < n; ++j) {
        const double* const column = M.data() + j * n;
        for (Index i = 0; i < n; ++i) use(i, j, column[i]);
      }
    });
  }
  void fit(const RowSparse& M) {
    fit(M.rows, [&](const auto& use) {
      for (Index i = 0; i < M.rows; ++i)
        for (auto k = at(M.start[at(i)]); k < at(M.start[at(i + 1)]); ++k) use(i, Index{M.column[k]}, M.value[k]);
    });
  }
  /// each(use) calls use(i, j, M_ij) for all entries.
  template <class Each> void fit(Index n, const Each& each) {
    double* const in_row = begin(n);
    double* const in_column = in_row + n;
    each([&](Index i, Index j, double value) {
      const double entry = std::abs(value);
      in_row[i] = std::max(in_row[i], entry);
      in_column[j] = std::max(in_column[j], entry);
    });
    finish(each);
  }
  /// diag(row) A diag(col), diag(row) b and the bounds over col, of dense A or rows. `scaled` may be `p` itself.
  void apply(const Lcp& p, Lcp& scaled) const {
    if (&scaled != &p) scaled = p;
    if (auto* dense = std::get_if<DenseMatrix>(&scaled.A)) {
      for (Index j = 0; j < dense->cols(); ++j) dense->col(j).array() *= row.array() * col[j];
    } else {
      auto& rows = std::get<RowSparse>(scaled.A);
      for (Index i = 0; i < rows.rows; ++i)
        for (auto k = at(rows.start[at(i)]); k < at(rows.start[at(i + 1)]); ++k)
          rows.value[k] *= row[i] * col[rows.column[k]];
    }
    scaled.b.array() *= row.array();
    scaled.lo.array() /= col.array();
    scaled.hi.array() /= col.array();
  }
  void clear() { trivial_ = true; }
  bool trivial() const { return trivial_; }  // all ones

 private:
  struct Entry {
    int i = 0, j = 0, exponent = 0;
  };
  /// Scales of 1, and room for the largest entry of each row, then of each column.
  double* begin(Index n) {
    row.resize(n);
    col.resize(n);
    row.setOnes();
    col.setOnes();
    largest_.resize(2 * n);
    largest_.setZero();
    return largest_.data();
  }
  template <class Each> void finish(const Each& each) {
    const Index n = row.size();
    double low = kInf, high = 0;
    for (const double size : largest_) {
      if (size == 0) continue;
      low = std::min(low, size);
      high = std::max(high, size);
    }
    trivial_ = high <= low * 0x1p24;
    if (trivial_) return;
    entries_.clear();
    each([this](Index i, Index j, double value) {
      if (value != 0 && std::isfinite(value))
        entries_.push_back({static_cast<int>(i), static_cast<int>(j), exponent(value)});
    });
    row_exponent_.assign(at(n), 0);
    col_exponent_.assign(at(n), 0);
    for (int sweep = 0; sweep < 4; ++sweep) {
      const bool columns = center(col_exponent_, row_exponent_, &Entry::j, &Entry::i);
      const bool rows = center(row_exponent_, col_exponent_, &Entry::i, &Entry::j);
      if (!columns && !rows) break;
    }
    for (Index i = 0; i < n; ++i) {
      row[i] = std::ldexp(1.0, row_exponent_[at(i)]);
      col[i] = std::ldexp(1.0, col_exponent_[at(i)]);
    }
  }
  static int exponent(double value) {  // std::ilogb without a call, except for denormal numbers
    const int biased = static_cast<int>(std::bit_cast<std::uint64_t>(value) >> 52 & 0x7ff);
    return biased != 0 ? biased - 1023 : std::ilogb(value);
  }
  /// The scales of one side (the rows or the columns) that bring the middle of their exponents to 0; false: no change.
  bool center(std::vector<int>& scale, const std::vector<int>& others, int Entry::*mine, int Entry::*other) {
    low_.assign(scale.size(), 5000);
    high_.assign(scale.size(), -5000);
    int* const low = low_.data();
    int* const high = high_.data();
    for (const Entry& entry : entries_) {
      const int k = entry.*mine, exponent = entry.exponent + others[static_cast<std::size_t>(entry.*other)];
      low[k] = std::min(low[k], exponent);
      high[k] = std::max(high[k], exponent);
    }
    bool changed = false;
    for (std::size_t k = 0; k < scale.size(); ++k) {
      const int before = scale[k];
      if (low[k] <= high[k]) scale[k] = std::clamp(-(low[k] + high[k]) / 2, -500, 500);
      changed = changed || scale[k] != before;
    }
    return changed;
  }
  Vector largest_;
  std::vector<Entry> entries_;
  std::vector<int> row_exponent_, col_exponent_, low_, high_;
  bool trivial_ = true;
};

}  // namespace orthant::detail
