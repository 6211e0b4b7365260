#include <orthant/solvers/linear_algebra/sparse_budget.h>
#include <orthant/solvers/linear_algebra/sparse_lu.h>

#include <algorithm>
#include <cmath>

namespace orthant {

SparseLu::SparseLu() {
  klu_defaults(&common_);
  common_.tol = 0.1;
  common_.scale = -1;  // the caller's business; and the caller's indices are right
}

SparseLu::~SparseLu() { release(); }

void SparseLu::release() {
  klu_free_numeric(&numeric_, &common_);
  klu_free_symbolic(&symbolic_, &common_);
}

bool SparseLu::factorize(std::vector<int>& start, std::vector<int>& row, std::vector<double>& value, double zero,
                         const Budget* budget) {
  release();
  least_ = largest_ = 1;
  const auto m = static_cast<int>(start.size()) - 1;
  if (m == 0) return true;
  if (value.empty()) return false;
  if (!affords_ordering(budget, m, start.data(), row.data())) return false;
  symbolic_ = klu_analyze(m, start.data(), row.data(), &common_);
  if (symbolic_ == nullptr || symbolic_->structural_rank < m) return false;
  if (budget != nullptr && !budget->affords(symbolic_->est_flops)) return false;
  numeric_ = klu_factor(start.data(), row.data(), value.data(), symbolic_, &common_);
  if (numeric_ == nullptr || common_.status != KLU_OK) return false;
  const auto* pivot = static_cast<const double*>(numeric_->Udiag);
  least_ = std::abs(pivot[0]), largest_ = 0;
  for (int k = 0; k < m; ++k) {
    if (!(std::abs(pivot[k]) > zero)) return false;  // NaN as well
    least_ = std::min(least_, std::abs(pivot[k]));
    largest_ = std::max(largest_, std::abs(pivot[k]));
  }
  return true;
}

void SparseLu::solve(double* x) {
  if (numeric_ != nullptr) klu_solve(symbolic_, numeric_, symbolic_->n, 1, x, &common_);
}

void SparseLu::solve_transposed(double* x) {
  if (numeric_ != nullptr) klu_tsolve(symbolic_, numeric_, symbolic_->n, 1, x, &common_);
}

}  // namespace orthant
