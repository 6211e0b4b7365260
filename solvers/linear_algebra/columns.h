// solvers/linear_algebra/columns.h — compressed columns of a matrix in any storage, for revised pivoting methods.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace orthant {

struct Columns {  // reuse it; column j: (row[e], value[e]), start[j] ≤ e < start[j + 1], rows ascending
  std::vector<int> start{0}, row;
  std::vector<double> value;

  Index size() const { return static_cast<Index>(start.size()) - 1; }

  /// The nonzeros of A (n × n), with `add` on the diagonal, which is stored in any case.
  void load(const Matrix& A, double add = 0) {
    const Index n = order(A);
    start.assign(1, 0);
    row.clear();
    value.clear();
    if (const auto* sparse = std::get_if<RowSparse>(&A)) {
      load(*sparse, add);
      return;
    }
    const DenseMatrix& dense = dense_of(A, formed_);
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i)
        if (dense(i, j) != 0 || i == j) append(i, dense(i, j) + (i == j ? add : 0.0));
      start.push_back(static_cast<int>(row.size()));
    }
  }

  /// Equal to the transpose, except for rounding (64 ε of the larger entry, or of √|A_ii A_jj|), zeros in equal places.
  bool symmetric() {
    const auto u = [](Index i) { return static_cast<std::size_t>(i); };
    diagonal_.resize(u(size()));
    for (Index j = 0; j < size(); ++j)
      each(j, [&](int i, double v) {
        if (i == j) diagonal_[u(j)] = std::sqrt(std::abs(v));
      });
    next_.assign(start.begin(),
                 start.end());  // column by column, the entries met in row i are the next ones of column i
    bool same = true;
    for (Index j = 0; j < size() && same; ++j)
      each(j, [&](int i, double v) {
        const auto mirrored = u(next_[u(i)]++);
        same = same && mirrored < u(start[u(i) + 1]) && row[mirrored] == j &&
               std::abs(value[mirrored] - v) <= 0x1p-46 * std::max(std::abs(v), diagonal_[u(i)] * diagonal_[u(j)]);
      });
    return same;
  }

  /// use(row, value) for column j.
  template <class Use> void each(Index j, const Use& use) const {
    const auto end = static_cast<std::size_t>(start[static_cast<std::size_t>(j) + 1]);
    for (auto e = static_cast<std::size_t>(start[static_cast<std::size_t>(j)]); e < end; ++e) use(row[e], value[e]);
  }

 private:
  void append(Index i, double v) {
    row.push_back(static_cast<int>(i));
    value.push_back(v);
  }
  void load(const RowSparse& A, double add) {  // transposed by counting
    const auto n = static_cast<std::size_t>(A.rows);
    start.assign(n + 1, 0);
    std::size_t missing = 0;
    for (std::size_t i = 0; i < n; ++i) {
      bool diagonal = false;
      for (auto e = static_cast<std::size_t>(A.start[i]); e < static_cast<std::size_t>(A.start[i + 1]); ++e) {
        ++start[static_cast<std::size_t>(A.column[e]) + 1];
        diagonal = diagonal || A.column[e] == static_cast<int>(i);
      }
      if (!diagonal) ++start[i + 1], ++missing;
    }
    for (std::size_t j = 0; j < n; ++j) start[j + 1] += start[j];
    row.resize(A.value.size() + missing);
    value.resize(row.size());
    next_.assign(start.begin(), start.end());
    for (std::size_t i = 0; i < n; ++i) {
      bool diagonal = false;
      const auto put = [&](std::size_t j, double v) {
        const auto place = static_cast<std::size_t>(next_[j]++);
        row[place] = static_cast<int>(i);
        value[place] = v;
      };
      for (auto e = static_cast<std::size_t>(A.start[i]); e < static_cast<std::size_t>(A.start[i + 1]); ++e) {
        const auto j = static_cast<std::size_t>(A.column[e]);
        diagonal = diagonal || j == i;
        put(j, A.value[e] + (j == i ? add : 0.0));
      }
      if (!diagonal) put(i, add);
    }
  }
  DenseMatrix formed_;
  std::vector<int> next_;
  std::vector<double> diagonal_;
};

}  // namespace orthant
