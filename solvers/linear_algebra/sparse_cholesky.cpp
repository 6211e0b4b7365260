#include <orthant/solvers/linear_algebra/sparse_budget.h>
#include <orthant/solvers/linear_algebra/sparse_cholesky.h>

#include <algorithm>

namespace orthant {

SparseCholesky::SparseCholesky() {
  cholmod_start(&common_);
  common_.print = 0;
  common_.supernodal = CHOLMOD_SIMPLICIAL;  // the dense blocks of the other kind are only as good as the BLAS at hand
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_AMD;
  common_.final_ll = 1;  // L D Lᵀ would go through with negative D
  common_.quick_return_if_not_posdef = 1;
}

SparseCholesky::~SparseCholesky() {
  cholmod_free_factor(&factor_, &common_);
  for (cholmod_dense** each : {&solution_, &work1_, &work2_}) cholmod_free_dense(each, &common_);
  cholmod_finish(&common_);
}

bool SparseCholesky::factorize(const RowSparse& A, double zero, const Budget* budget) {
  if (A.rows == 0) return true;
  if (A.value.empty()) return false;
  cholmod_sparse view{};  // compressed rows of a symmetric matrix are its compressed columns; CHOLMOD only reads them
  view.nrow = view.ncol = static_cast<std::size_t>(A.rows);
  view.nzmax = A.value.size();
  view.p = const_cast<int*>(A.start.data());
  view.i = const_cast<int*>(A.column.data());
  view.x = const_cast<double*>(A.value.data());
  view.stype = 1;
  view.itype = CHOLMOD_INT, view.xtype = CHOLMOD_REAL, view.dtype = CHOLMOD_DOUBLE;
  view.sorted = view.packed = 1;
  if (factor_ == nullptr || A.start != start_ || A.column != column_) {
    if (!affords_ordering(budget, static_cast<int>(A.rows), A.start.data(), A.column.data())) return false;
    cholmod_free_factor(&factor_, &common_);
    factor_ = cholmod_analyze(&view, &common_);
    start_ = A.start, column_ = A.column;
    operations_ = 2 * common_.fl;  // as an LU factorization's
  }
  if (budget != nullptr && !budget->affords(operations_)) return false;
  return factor_ != nullptr && cholmod_factorize(&view, factor_, &common_) != 0 && common_.status == CHOLMOD_OK &&
         factor_->minor == factor_->n && cholmod_rcond(factor_, &common_) > zero;
}

bool SparseCholesky::solve(Vector& x) {
  if (x.size() == 0) return true;
  cholmod_dense rhs{};
  rhs.nrow = rhs.nzmax = rhs.d = static_cast<std::size_t>(x.size());
  rhs.ncol = 1;
  rhs.x = x.data();
  rhs.xtype = CHOLMOD_REAL, rhs.dtype = CHOLMOD_DOUBLE;
  if (cholmod_solve2(CHOLMOD_A, factor_, &rhs, nullptr, &solution_, nullptr, &work1_, &work2_, &common_) == 0)
    return false;
  std::copy_n(static_cast<const double*>(solution_->x), x.size(), x.data());
  return true;
}

}  // namespace orthant
