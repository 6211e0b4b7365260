// solvers/linear_algebra/sparse_lu.h — sparse LU factorization by KLU (SuiteSparse).
//
//   Block triangular form first, then each diagonal block with partial pivoting (threshold 0.1, approximate minimum
//   degree): the columns of a basis with one entry each cost nothing.
//   Source: Davis & Palamadai Natarajan, ACM Trans. Math. Softw. 37 (2010), Algorithm 907.
#pragma once

#include <orthant/solvers/budget.h>

#include <klu.h>

#include <vector>

namespace orthant {

class SparseLu {
 public:
  SparseLu();
  ~SparseLu();
  SparseLu(const SparseLu&) = delete;
  SparseLu& operator=(const SparseLu&) = delete;

  /// Compressed columns, m × m, every row index once a column. False when singular: a pivot ≤ zero in absolute value;
  /// and when the budget (null: none) does not afford the operations that the analysis predicts.
  bool factorize(std::vector<int>& start, std::vector<int>& row, std::vector<double>& value, double zero,
                 const Budget* budget = nullptr);

  void solve(double* x);             // x ← A⁻¹ x
  void solve_transposed(double* x);  // x ← A⁻ᵀ x
  double least_pivot() const { return least_; }
  double largest_pivot() const { return largest_; }

 private:
  void release();
  klu_common common_{};
  klu_symbolic* symbolic_ = nullptr;
  klu_numeric* numeric_ = nullptr;
  double least_ = 1, largest_ = 1;
};

}  // namespace orthant
