// Entries of a matrix as exact or long numbers, of an operator too.
#pragma once

#include <orthant/core/lcp/matrix.h>

#include <cmath>
#include <vector>

namespace orthant {

/// use(i, j, A_ij, size) for the entries with size ≠ 0, j ascending in each row; size: the sum of |terms| of A_ij.
template <class T, class Use> void for_each_entry_as(const Matrix& A, const Use& use) {
  if (for_each_entry(A, [&use](Index i, Index j, double a) {
        if (a != 0) use(i, j, T(a), T(std::abs(a)));
      }))
    return;
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  std::vector<std::vector<T>> factor(at(W.rows), std::vector<T>(at(W.cols), T(0)));
  for (Index i = 0; i < W.rows; ++i)
    W.for_each_in_row(i, [&factor, i](Index k, double w) { factor[at(i)][at(k)] += T(w); });
  for (Index i = 0; i < W.rows; ++i)
    for (Index j = 0; j < W.rows; ++j) {
      T sum(i == j && regularization.size() != 0 ? regularization[i] : 0.0), size = sum;
      for (Index k = 0; k < W.cols; ++k) {
        if (factor[at(i)][at(k)] == 0 || factor[at(j)][at(k)] == 0) continue;
        const T term = factor[at(i)][at(k)] * factor[at(j)][at(k)] * T(inverse_mass[k]);
        sum += term, size += abs(term);
      }
      if (size != 0) use(i, j, sum, size);
    }
}

}  // namespace orthant
