#include <orthant/solvers/principal_block.h>
#include <orthant/solvers/scaling.h>

#include <Eigen/Dense>
#include <Eigen/UmfPackSupport>

#include <cmath>

namespace orthant {
namespace {

constexpr Index kEmbedded = 64;
constexpr double kGrowth = 1e4;
constexpr double kSingular = 1e-15;  // reciprocal condition number below which a factorization is not trusted

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

struct PrincipalBlock::Dense {
  DenseMatrix formed;
  const DenseMatrix* A = nullptr;
  detail::Scaling scaling;  // so that "singular" does not depend on units
  Eigen::MatrixXd block;
  Eigen::LLT<Eigen::MatrixXd> llt;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
  Eigen::FullPivLU<Eigen::MatrixXd> full;
  enum class Kind { cholesky, partial, complete } kind = Kind::partial;
  Eigen::VectorXd rhs, step;

  bool factorize(const std::vector<Index>& F, bool symmetric) {
    const Index m = static_cast<Index>(F.size()), n = A->rows() <= kEmbedded ? A->rows() : m;
    block.setIdentity(n, n);
    for (Index j = 0; j < m; ++j)
      for (Index i = 0; i < m; ++i)
        block(i, j) = (*A)(F[at(i)], F[at(j)]) * scaling.row[F[at(i)]] * scaling.col[F[at(j)]];
    if (m == 0) return true;
    if (symmetric) {
      llt.compute(block);
      kind = Kind::cholesky;
      if (llt.info() == Eigen::Success && llt.rcond() > kSingular) return true;
    }
    if (!block.allFinite()) return false;
    lu.compute(block);
    kind = Kind::partial;
    const double growth = lu.matrixLU().cwiseAbs().maxCoeff() / block.cwiseAbs().maxCoeff();
    if (growth < kGrowth) return lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0 && lu.rcond() > kSingular;
    full.compute(block);  // partial pivoting lets entries grow, up to 2ᵐ⁻¹ (Wilkinson): complete pivoting does not
    kind = Kind::complete;
    return full.isInvertible() && full.rcond() > kSingular;
  }
  void solve(const std::vector<Index>& F, const Vector& r, Vector& x) {
    const Index m = r.size();
    x.resize(m);
    if (m == 0) return;
    rhs.setZero(block.rows());
    x.setZero();
    for (int round = 0; round < 2; ++round) {
      for (Index i = 0; i < m; ++i) {
        long double sum = r[i];
        for (Index j = 0; round > 0 && j < m; ++j) sum -= static_cast<long double>((*A)(F[at(i)], F[at(j)])) * x[j];
        rhs[i] = static_cast<double>(sum) * scaling.row[F[at(i)]];
      }
      apply();
      for (Index i = 0; i < m; ++i) x[i] += rhs[i] * scaling.col[F[at(i)]];
    }
  }
  void apply() {
    switch (kind) {
      case Kind::cholesky:
        llt.solveInPlace(rhs);
        break;
      case Kind::partial:
        step.noalias() = lu.permutationP() * rhs;
        lu.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(step);
        lu.matrixLU().triangularView<Eigen::Upper>().solveInPlace(step);
        rhs.swap(step);
        break;
      case Kind::complete:
        rhs = full.solve(rhs).eval();
    }
  }
};

struct PrincipalBlock::Sparse {
  const RowSparse* A = nullptr;
  Eigen::SparseMatrix<double> block;
  Eigen::UmfPackLU<Eigen::SparseMatrix<double>> lu;
  std::vector<int> position;  // row of A → row of the block, or −1
  std::vector<Eigen::Triplet<double>> entries;

  bool factorize(const std::vector<Index>& F) {
    const Index m = static_cast<Index>(F.size());
    if (m == 0) return true;
    position.assign(at(A->rows), -1);
    for (Index k = 0; k < m; ++k) position[at(F[at(k)])] = static_cast<int>(k);
    entries.clear();
    for (Index i = 0; i < m; ++i)
      for (auto k = at(A->start[at(F[at(i)])]); k < at(A->start[at(F[at(i)]) + 1]); ++k)
        if (const int j = position[at(A->column[k])]; j >= 0) entries.emplace_back(static_cast<int>(i), j, A->value[k]);
    block.resize(m, m);
    block.setFromTriplets(entries.begin(), entries.end());
    lu.compute(block);
    return lu.info() == Eigen::Success;
  }
  void solve(const Vector& r, Vector& x) {
    x.resize(r.size());
    if (r.size() == 0) return;
    Eigen::VectorXd rhs = r;
    x = lu.solve(rhs);
    rhs -= block * x;
    const Eigen::VectorXd correction = lu.solve(rhs);
    x += correction;
  }
};

PrincipalBlock::PrincipalBlock() : dense_(std::make_unique<Dense>()) {}
PrincipalBlock::~PrincipalBlock() = default;

void PrincipalBlock::load(const Matrix& A) {
  is_sparse_ = std::holds_alternative<RowSparse>(A);
  if (is_sparse_) {
    if (!sparse_) sparse_ = std::make_unique<Sparse>();
    sparse_->A = &std::get<RowSparse>(A);
    return;
  }
  dense_->A = std::get_if<DenseMatrix>(&A);
  if (dense_->A == nullptr) {
    to_dense(A, dense_->formed);
    dense_->A = &dense_->formed;
  }
  dense_->scaling.fit(*dense_->A);
  symmetric_ = dense_->scaling.row == dense_->scaling.col;
  for (Index j = 0; j < dense_->A->cols() && symmetric_; ++j)
    for (Index i = 0; i < j && symmetric_; ++i) symmetric_ = (*dense_->A)(i, j) == (*dense_->A)(j, i);
}

bool PrincipalBlock::factorize(const std::vector<Index>& F) {
  F_ = F;
  return is_sparse_ ? sparse_->factorize(F) : dense_->factorize(F, symmetric_);
}

void PrincipalBlock::solve(const Vector& r, Vector& x) {
  if (is_sparse_)
    sparse_->solve(r, x);
  else
    dense_->solve(F_, r, x);
}

}  // namespace orthant
