// solvers/scaling.h — powers of 2 that bring the entries of diag(row) M diag(col) together.
//
//   Powers of 2, so that scaling costs no rounding. Ones when the rows' and columns' largest entries are within 2²⁴ of
//   each other already: then scaling would only change the path.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace orthant::detail {

class Scaling {  // reuse it: the second problem of a size allocates nothing
 public:
  Vector row, col;

  void fit(const DenseMatrix& M) {
    const Index n = M.rows();
    fit(n, [&](const auto& use) {
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
    row.resize(n);
    col.resize(n);
    row.setOnes();
    col.setOnes();
    largest_.resize(2 * n);  // of each row, of each column
    largest_.setZero();
    double* const in_row = largest_.data();
    double* const in_column = in_row + n;
    each([&](Index i, Index j, double value) {
      const double entry = std::abs(value);
      in_row[i] = std::max(in_row[i], entry);
      in_column[j] = std::max(in_column[j], entry);
    });
    double low = kInf, high = 0;
    for (const double size : largest_) {
      if (size == 0) continue;
      low = std::min(low, size);
      high = std::max(high, size);
    }
    trivial_ = high <= low * 0x1p24;
    if (trivial_) return;
    for (int sweep = 0; sweep < 4; ++sweep) {
      center(col, each, [&](Index i, Index j, double value) { return std::pair(j, value * row[i]); });
      center(row, each, [&](Index i, Index j, double value) { return std::pair(i, value * col[j]); });
    }
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
  /// The middle of the exponents of each column, or of each row: term(i, j, M_ij) is its index and a scaled entry.
  template <class Each, class Term> void center(Vector& scale, const Each& each, const Term& term) {
    range_.assign(at(scale.size()), {5000, -5000});
    each([&](Index i, Index j, double entry) {
      const auto [k, value] = term(i, j, entry);
      if (value == 0 || !std::isfinite(value)) return;
      auto& [low, high] = range_[at(k)];
      const int exponent = std::ilogb(value);
      low = std::min(low, exponent);
      high = std::max(high, exponent);
    });
    for (Index k = 0; k < scale.size(); ++k)
      if (const auto [low, high] = range_[at(k)]; low <= high)
        scale[k] = std::ldexp(1.0, std::clamp(-(low + high) / 2, -500, 500));
  }
  Vector largest_;
  std::vector<std::pair<int, int>> range_;
  bool trivial_ = true;
};

}  // namespace orthant::detail
