// solvers/scaling.h — powers of 2 that bring the entries of diag(row) M diag(col) together.
//
//   Powers of 2, so that scaling costs no rounding. Ones when the rows' and columns' largest entries are within 2²⁴ of
//   each other already: then scaling would only change the path.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>

namespace orthant::detail {

class Scaling {  // reuse it: the second problem of a size allocates nothing
 public:
  Vector row, col;

  void fit(const DenseMatrix& M) {
    const Index n = M.rows();
    row.resize(n);
    col.resize(n);
    row.setOnes();
    col.setOnes();
    largest_.resize(n);
    largest_.setZero();
    double low = kInf, high = 0;
    const auto count = [&](double size) {
      if (size == 0) return;
      low = std::min(low, size);
      high = std::max(high, size);
    };
    for (Index j = 0; j < n; ++j) {
      double size = 0;
      const double* const column = M.data() + j * n;
      for (Index i = 0; i < n; ++i) {
        const double entry = std::abs(column[i]);
        size = std::max(size, entry);
        largest_[i] = std::max(largest_[i], entry);
      }
      count(size);
    }
    for (Index i = 0; i < n; ++i) count(largest_[i]);
    if (high <= low * 0x1p24) return;
    for (int sweep = 0; sweep < 4; ++sweep) {  // middle of the exponents of each column, then of each row
      for (Index j = 0; j < n; ++j)
        center(
            col[j], [&](Index i) { return M(i, j) * row[i]; }, n);
      for (Index i = 0; i < n; ++i)
        center(
            row[i], [&](Index j) { return M(i, j) * col[j]; }, n);
    }
  }

 private:
  template <class Entry> static void center(double& scale, const Entry& entry, Index n) {
    int low = 5000, high = -5000;
    for (Index k = 0; k < n; ++k) {
      const double value = entry(k);
      if (value == 0 || !std::isfinite(value)) continue;
      low = std::min(low, std::ilogb(value));
      high = std::max(high, std::ilogb(value));
    }
    if (low <= high) scale = std::ldexp(1.0, std::clamp(-(low + high) / 2, -500, 500));
  }
  Vector largest_;
};

}  // namespace orthant::detail
