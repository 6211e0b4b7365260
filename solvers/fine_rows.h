// solvers/fine_rows.h — rows with terms small compared with those of other rows, solved to their own scale.
//
//   Forces of 1e-20 N in a pile of 1 N: a method that stops at the rounding of the largest row leaves such rows with
//   relative violations far above the judge's limit (judge/certify.h: s_i and β_i are a row's own). Here the rows that
//   violate, and those that they disturb in turn, are swept in long double by projected Gauss-Seidel, while the others
//   stay. Linear convergence; meant for few rows that couple weakly to the rest.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <vector>

namespace orthant {

class FineRows {  // reuse it: the members are scratch
 public:
  /// Room for problems of n rows: settle() then allocates nothing except the entries of an operator.
  void reserve(Index n);
  /// to ← z with the violated rows settled. False: none is violated, too many are, or one has no positive diagonal.
  bool settle(const Lcp& problem, const Vector& z, Vector& to);

 private:
  bool violated(const Lcp& problem, Index i, const Vector& z);
  void bounds(const Lcp& problem, Index i, const Vector& z, double& lo, double& hi) const;

  RowSparse entries_;  // of an operator
  const RowSparse* rows_ = nullptr;
  const DenseMatrix* dense_ = nullptr;
  Vector diagonal_;
  std::vector<Index> friction_of_, swept_;
  std::vector<char> in_;
  long double w_ = 0;  // of the row last looked at
};

}  // namespace orthant
