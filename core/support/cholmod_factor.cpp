#include <orthant/core/support/cholmod_factor.h>

#include <algorithm>

namespace orthant {
namespace {

/// CHOLMOD only reads it.
cholmod_sparse view(const SymmetricColumns& A) {
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = A.start.size() - 1;
  matrix.nzmax = A.value.size();
  matrix.p = const_cast<int*>(A.start.data());
  matrix.i = const_cast<int*>(A.index.data());
  matrix.x = const_cast<double*>(A.value.data());
  matrix.stype = 1;
  matrix.itype = CHOLMOD_INT, matrix.xtype = CHOLMOD_REAL, matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = matrix.packed = 1;
  return matrix;
}

}  // namespace

CholmodFactor::CholmodFactor() {
  cholmod_start(&common_);
  common_.print = 0;
  common_.supernodal = CHOLMOD_SIMPLICIAL;  // the dense blocks of the other kind are only as good as the BLAS at hand
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_AMD;
  common_.final_ll = 1;  // L D Lᵀ would go through with negative D
  common_.quick_return_if_not_posdef = 1;
}

CholmodFactor::~CholmodFactor() {
  cholmod_free_factor(&factor_, &common_);
  for (cholmod_dense** each : {&solution_, &work1_, &work2_}) cholmod_free_dense(each, &common_);
  cholmod_finish(&common_);
}

bool CholmodFactor::analyse(const SymmetricColumns& A) {
  cholmod_sparse matrix = view(A);
  cholmod_free_factor(&factor_, &common_);
  factor_ = cholmod_analyze(&matrix, &common_);
  operations_ = common_.fl;
  return factor_ != nullptr;
}

bool CholmodFactor::factorize(const SymmetricColumns& A, double zero) {
  cholmod_sparse matrix = view(A);
  return factor_ != nullptr && cholmod_factorize(&matrix, factor_, &common_) != 0 && common_.status == CHOLMOD_OK &&
         factor_->minor == factor_->n && cholmod_rcond(factor_, &common_) > zero;
}

bool CholmodFactor::solve(std::span<double> x) {
  cholmod_dense rhs{};
  rhs.nrow = rhs.nzmax = rhs.d = x.size();
  rhs.ncol = 1;
  rhs.x = x.data();
  rhs.xtype = CHOLMOD_REAL, rhs.dtype = CHOLMOD_DOUBLE;
  if (cholmod_solve2(CHOLMOD_A, factor_, &rhs, nullptr, &solution_, nullptr, &work1_, &work2_, &common_) == 0)
    return false;
  std::copy_n(static_cast<const double*>(solution_->x), x.size(), x.data());
  return true;
}

void CholmodFactor::pivot_shares(std::span<const double> diagonal, std::span<double> shares) const {
  const auto* start = static_cast<const int*>(factor_->p);
  const auto* order = static_cast<const int*>(factor_->Perm);
  const auto* value = static_cast<const double*>(factor_->x);
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    const double root = value[start[i]];
    const auto row = static_cast<std::size_t>(order[i]);
    shares[row] = root * root / diagonal[row];
  }
}

}  // namespace orthant
