#include <orthant/solvers/derivatives/active_system.h>
#include <orthant/solvers/linear_algebra/sparse_cholesky.h>
#include <orthant/solvers/linear_algebra/sparse_lu.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

constexpr double kShiftOfLeastNorm = 1e-6;  // α
constexpr double kShiftOfMonotone = 1e-7;   // δ
constexpr double kOutOfReach = 1e-8;        // of the right-hand side: less is rounding

Eigen::SparseMatrix<double> identity_rows(Index n) {
  Eigen::SparseMatrix<double> unit(n, n);
  unit.setIdentity();
  return unit;
}

// Blocks side by side, zero where null.
Eigen::SparseMatrix<double> two_by_two(const Eigen::SparseMatrix<double>& a, const Eigen::SparseMatrix<double>& b,
                                       const Eigen::SparseMatrix<double>& c, const Eigen::SparseMatrix<double>& d) {
  std::vector<Eigen::Triplet<double, int>> entries;
  const auto add = [&](const Eigen::SparseMatrix<double>& block, Index row, Index column) {
    for (Index j = 0; j < block.outerSize(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(block, j); it; ++it)
        entries.emplace_back(static_cast<int>(row + it.row()), static_cast<int>(column + j), it.value());
  };
  add(a, 0, 0), add(b, 0, a.cols()), add(c, a.rows(), 0), add(d, a.rows(), a.cols());
  Eigen::SparseMatrix<double> all(a.rows() + c.rows(), a.cols() + b.cols());
  all.setFromTriplets(entries.begin(), entries.end());
  return all;
}

bool same(double a, double b) { return std::abs(a - b) <= 1e-14 * std::max(std::abs(a), std::abs(b)); }

bool symmetric_within_rounding(const Eigen::MatrixXd& B) {
  constexpr Index kTile = 64;  // both triangles in the cache
  const Index n = B.rows();
  for (Index j0 = 0; j0 < n; j0 += kTile)
    for (Index i0 = j0; i0 < n; i0 += kTile)
      for (Index j = j0; j < std::min(n, j0 + kTile); ++j)
        for (Index i = std::max(j + 1, i0); i < std::min(n, i0 + kTile); ++i)
          if (!same(B(i, j), B(j, i))) return false;
  return true;
}

bool symmetric_within_rounding(const Eigen::SparseMatrix<double>& B) {
  const Eigen::SparseMatrix<double> transposed = B.transpose();
  if (transposed.nonZeros() != B.nonZeros()) return false;
  for (Index j = 0; j < B.outerSize(); ++j) {
    Eigen::SparseMatrix<double>::InnerIterator t(transposed, j);
    for (Eigen::SparseMatrix<double>::InnerIterator it(B, j); it; ++it, ++t)
      if (!t || t.row() != it.row() || !same(t.value(), it.value())) return false;
  }
  return true;
}

// SparseLu takes vectors of its own.
bool factorize_sparse(SparseLu& lu, const Eigen::SparseMatrix<double>& B) {
  std::vector<int> start(B.outerIndexPtr(), B.outerIndexPtr() + B.cols() + 1),
      row(B.innerIndexPtr(), B.innerIndexPtr() + B.nonZeros());
  std::vector<double> value(B.valuePtr(), B.valuePtr() + B.nonZeros());
  return lu.factorize(start, row, value, 0);
}

}  // namespace

struct ActiveSystem::Factors {
  enum class Kind {
    none,
    dense_cholesky,
    dense_lu,
    orthogonal,
    sparse_cholesky,
    sparse_lu,
    proximal
  } kind = Kind::none;
  Eigen::LLT<Eigen::MatrixXd> cholesky;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> orthogonal;
  SparseCholesky sparse_cholesky;
  SparseLu sparse_lu;
  Vector scratch;
};

ActiveSystem::ActiveSystem() : factors_(std::make_unique<Factors>()) {}
ActiveSystem::~ActiveSystem() = default;
ActiveSystem::ActiveSystem(ActiveSystem&&) noexcept = default;
ActiveSystem& ActiveSystem::operator=(ActiveSystem&&) noexcept = default;

void ActiveSystem::factorize(const Matrix& A, const Sparse& E, const Sparse& P, const Eigen::VectorXd& D) {
  unknowns_ = D.size(), extra_ = 0, singular_ = monotone_ = false, rcond_ = 1;
  if (factors_->kind != Factors::Kind::none) factors_ = std::make_unique<Factors>();
  if (unknowns_ == 0) return;
  form(A, E, P, D);
  const bool definite = scale_rows_and_columns();  // perhaps
  factorize_regular(definite);
  rcond_ = factors_->kind == Factors::Kind::none ? 0 : estimate_condition();
  const double noise = 16 * std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(extra_ + unknowns_));
  if (rcond_ > noise) return;
  singular_ = true;
  factorize_singular(definite || (extra_ > 0 && (E - P).norm() == 0), noise);
}

/// The matrix, dense where A is; else sparse, with the rows of u first where A is a Delassus matrix.
void ActiveSystem::form(const Matrix& A, const Sparse& E, const Sparse& P, const Eigen::VectorXd& D) {
  Sparse diagonal_part(unknowns_, unknowns_);
  diagonal_part.setIdentity();
  diagonal_part.diagonal() = D;
  const auto* dense = std::get_if<DenseMatrix>(&A);
  dense_ = dense != nullptr;
  if (dense_) {
    full_.resize(unknowns_, unknowns_);
    std::vector<Index> row(at(unknowns_));  // of P's columns, where each has a single 1
    bool plain = true;
    for (Index i = 0; i < unknowns_; ++i) {
      Sparse::InnerIterator it(P, i);
      row[at(i)] = it.row();
      plain = plain && it.value() == 1 && !(++it);
    }
    Eigen::VectorXd column;  // A E_j
    for (Index j = 0; j < unknowns_; ++j) {
      Sparse::InnerIterator it(E, j);
      const Index k = it.row();
      const double factor = it.value();
      const double* from = dense->col(k).data();
      if (++it || factor != 1) {
        column = factor * dense->col(k);
        for (; it; ++it) column += it.value() * dense->col(it.row());
        from = column.data();
      }
      for (Index i = 0; i < unknowns_; ++i)
        if (plain) {
          full_(i, j) = from[row[at(i)]];
        } else {
          double sum = 0;
          for (Sparse::InnerIterator part(P, i); part; ++part) sum += part.value() * from[part.row()];
          full_(i, j) = sum;
        }
    }
    full_.diagonal() += D;
  } else if (const auto* sparse = std::get_if<RowSparse>(&A)) {
    const Sparse columns = sparse->view() * E;
    rows_ = Sparse(P.transpose()) * columns + diagonal_part;
  } else {
    const auto& operator_ = std::get<Delassus>(A);
    const Sparse W = operator_.W.view();
    extra_ = W.cols();
    const Sparse WE = Sparse(W.transpose()) * E, PW = Sparse(P.transpose()) * W;
    const Sparse to_u = Eigen::VectorXd(-operator_.inverse_mass).asDiagonal() * WE;
    if (operator_.regularization.size() > 0) {
      const Sparse RE = operator_.regularization.asDiagonal() * E;
      diagonal_part = Sparse(Sparse(P.transpose()) * RE) + diagonal_part;
    }
    rows_ = two_by_two(identity_rows(extra_), to_u, PW, diagonal_part);
  }
}

void ActiveSystem::factorize_regular(bool definite) {
  using Kind = Factors::Kind;
  Factors& f = *factors_;
  if (dense_) {
    if (definite) {
      f.cholesky.compute(full_);
      if (f.cholesky.info() == Eigen::Success) f.kind = Kind::dense_cholesky;
    }
    if (f.kind == Kind::none) {
      f.lu.compute(full_);
      if (f.lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0) f.kind = Kind::dense_lu;
    }
  } else {
    if (definite &&
        f.sparse_cholesky.factorize(RowSparse::from(Eigen::SparseMatrix<double, Eigen::RowMajor>(rows_)), 0))
      f.kind = Kind::sparse_cholesky;
    else if (factorize_sparse(f.sparse_lu, rows_))
      f.kind = Kind::sparse_lu;
  }
}

/// monotone: positive semidefinite, or nearly. noise: below it a pivot of the orthogonal decomposition is zero.
void ActiveSystem::factorize_singular(bool monotone, double noise) {
  using Kind = Factors::Kind;
  Factors& f = *factors_;
  const Index n = extra_ + unknowns_;
  if (monotone) {
    if (dense_) {
      Eigen::MatrixXd shifted = full_;
      shifted.diagonal().array() += kShiftOfMonotone;
      f.cholesky.compute(shifted);
      if (f.cholesky.info() == Eigen::Success) f.kind = Kind::dense_cholesky, monotone_ = true;
    } else {
      Sparse shift = kShiftOfMonotone * identity_rows(n);
      shift.diagonal().head(extra_).setZero();
      const Sparse shifted = rows_ + shift;
      if (extra_ > 0)
        monotone_ = factorize_sparse(f.sparse_lu, shifted), f.kind = Kind::sparse_lu;
      else
        monotone_ =
            f.sparse_cholesky.factorize(RowSparse::from(Eigen::SparseMatrix<double, Eigen::RowMajor>(shifted)), 0),
        f.kind = Kind::sparse_cholesky;
    }
    if (monotone_) return;
  }
  if (dense_) {
    f.orthogonal.setThreshold(noise);
    f.orthogonal.compute(full_);
    f.kind = Kind::orthogonal;
  } else {
    const Sparse shift = kShiftOfLeastNorm * identity_rows(n);
    f.kind = factorize_sparse(f.sparse_lu, two_by_two(shift, rows_, rows_.transpose(), -shift)) ? Kind::proximal
                                                                                                : Kind::none;
  }
}

// Symmetric where the matrix is: D^(−½) from the diagonal; else rows, then columns, by their largest entries.
bool ActiveSystem::scale_rows_and_columns() {
  const Index n = extra_ + unknowns_;
  row_.setOnes(n), column_.setOnes(n);
  const auto inverse = [](const Eigen::VectorXd& largest) {
    return Eigen::VectorXd(largest.unaryExpr([](double x) { return x > 0 ? 1 / x : 1; }));
  };
  if (dense_) {
    const bool definite = (full_.diagonal().array() > 0).all() && symmetric_within_rounding(full_);
    if (definite) {
      row_ = column_ = inverse(full_.diagonal().cwiseSqrt());
    } else {
      row_ = inverse(full_.cwiseAbs().rowwise().maxCoeff());
      column_ = inverse((row_.asDiagonal() * full_).cwiseAbs().colwise().maxCoeff());
    }
    full_ = row_.asDiagonal() * full_ * column_.asDiagonal();
    return definite;
  }
  const Eigen::VectorXd diagonal_now = rows_.diagonal();
  const bool definite = extra_ == 0 && (diagonal_now.array() > 0).all() && symmetric_within_rounding(rows_);
  if (definite) {
    row_ = column_ = inverse(diagonal_now.cwiseSqrt());
  } else {
    for (int pass = 0; pass < 2; ++pass) {  // [u]'s rows have units of their own
      Eigen::VectorXd largest = Eigen::VectorXd::Zero(n), of_column = largest;
      for (Index j = 0; j < n; ++j)
        for (Sparse::InnerIterator it(rows_, j); it; ++it)
          largest[it.row()] = std::max(largest[it.row()], std::abs(it.value()) * row_[it.row()] * column_[j]);
      row_ = row_.cwiseProduct(inverse(largest));
      for (Index j = 0; j < n; ++j)
        for (Sparse::InnerIterator it(rows_, j); it; ++it)
          of_column[j] = std::max(of_column[j], std::abs(it.value()) * row_[it.row()] * column_[j]);
      column_ = column_.cwiseProduct(inverse(of_column));
    }
  }
  rows_ = row_.asDiagonal() * rows_ * column_.asDiagonal();
  return definite;
}

void ActiveSystem::apply_inverse(Eigen::VectorXd& x, bool transposed) const {
  Factors& f = *factors_;
  using Kind = Factors::Kind;
  if (f.kind == Kind::dense_cholesky) {
    f.cholesky.solveInPlace(x);
  } else if (f.kind == Kind::dense_lu) {
    x = transposed ? Eigen::VectorXd(f.lu.transpose().solve(x)) : Eigen::VectorXd(f.lu.solve(x));
  } else if (f.kind == Kind::sparse_cholesky) {
    f.scratch = x;
    f.sparse_cholesky.solve(f.scratch);
    x = f.scratch;
  } else {
    transposed ? f.sparse_lu.solve_transposed(x.data()) : f.sparse_lu.solve(x.data());
  }
}

double ActiveSystem::estimate_condition() const {
  const Index n = extra_ + unknowns_;
  double norm = 0;  // ‖B‖₁
  if (dense_) {
    norm = full_.cwiseAbs().colwise().sum().maxCoeff();
  } else {
    for (Index j = 0; j < n; ++j) {
      double sum = 0;
      for (Sparse::InnerIterator it(rows_, j); it; ++it) sum += std::abs(it.value());
      norm = std::max(norm, sum);
    }
  }
  Eigen::VectorXd x = Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
  double inverse = 0;  // ‖B⁻¹‖₁ from below
  for (int pass = 0; pass < 5; ++pass) {
    apply_inverse(x, false);
    const double now = x.lpNorm<1>();
    if (!std::isfinite(now)) return 0;
    if (!(now > inverse)) break;
    inverse = now;
    x = x.unaryExpr([](double value) { return value < 0 ? -1.0 : 1.0; });
    apply_inverse(x, true);
    Index largest = 0;
    if (!(x.cwiseAbs().maxCoeff(&largest) > 0)) break;
    x.setZero();
    x[largest] = 1;
  }
  for (Index i = 0; i < n; ++i)  // where the iteration is misled
    x[i] = (i % 2 == 0 ? 1.0 : -1.0) * (1 + static_cast<double>(i) / static_cast<double>(std::max<Index>(1, n - 1)));
  apply_inverse(x, false);
  inverse = std::max(inverse, 2 * x.lpNorm<1>() / (3 * static_cast<double>(n)));
  const double product = norm * inverse;
  return product > 0 && std::isfinite(product) ? 1 / product : 0;
}

double ActiveSystem::least_norm(Eigen::VectorXd& x, bool transposed) const {
  Factors& f = *factors_;
  Eigen::VectorXd r = x;
  const double size = r.lpNorm<Eigen::Infinity>();
  if (!(size > 0)) return 0;
  const auto residual = [&](const Eigen::VectorXd& y) -> Eigen::VectorXd {
    if (dense_) return r - (transposed ? Eigen::VectorXd(full_.transpose() * y) : Eigen::VectorXd(full_ * y));
    return r - (transposed ? Eigen::VectorXd(rows_.transpose() * y) : Eigen::VectorXd(rows_ * y));
  };
  if (f.kind == Factors::Kind::orthogonal) {
    x = transposed ? Eigen::VectorXd(f.orthogonal.transpose().solve(r)) : Eigen::VectorXd(f.orthogonal.solve(r));
    return residual(x).lpNorm<Eigen::Infinity>() / size;
  }
  const Index n = r.size();
  Eigen::VectorXd both(2 * n), left = r;
  double before = kInf, off = 0;
  if (monotone_) {  // what no y reaches would be divided by δ
    x = left;
    apply_inverse(x, transposed);
    r = residual(x);
    for (int pass = 1; pass < 5 && r.lpNorm<Eigen::Infinity>() > kOutOfReach * size; ++pass) {
      x = r;
      apply_inverse(x, transposed);
      r = residual(x);  // (I − B (B + δ I)⁻¹)ⁿ of the right-hand side: that part alone
    }
    if (off = r.lpNorm<Eigen::Infinity>() / size; off > kOutOfReach)
      left -= r;
    else
      off = 0;
    r = left;
  }
  x.setZero();
  for (int pass = 0; pass < 20; ++pass) {
    Eigen::VectorXd trial = left;
    if (monotone_) {
      apply_inverse(trial, transposed);
    } else {
      both.setZero();  // forward [r − B y; 0] → (·, step); transposed [0; r − Bᵀ y] → (step, ·)
      (transposed ? both.tail(n) : both.head(n)) = left;
      f.sparse_lu.solve(both.data());
      trial = transposed ? both.head(n) : both.tail(n);
    }
    trial += x;
    left = residual(trial);
    const double now = left.lpNorm<Eigen::Infinity>();
    if (!(now < 0.9 * before)) break;
    x = trial, before = now;
  }
  return std::max(off, before / size);
}

double ActiveSystem::solve_as(Eigen::VectorXd& r, bool transposed) const {
  if (unknowns_ == 0) return 0;
  // The saddle-point system's u is 0 on the right, and is dropped; transposed as well: B⁻ᵀ is the last block of both.
  Eigen::VectorXd x = Eigen::VectorXd::Zero(extra_ + unknowns_);
  x.tail(unknowns_) = r;
  x = x.cwiseProduct(transposed ? column_ : row_);
  double off = 0;
  if (singular_) {
    off = least_norm(x, transposed);
  } else {
    const Eigen::VectorXd right = x;
    apply_inverse(x, transposed);
    Eigen::VectorXd left = right;  // one step of refinement
    if (dense_)
      left -= transposed ? Eigen::VectorXd(full_.transpose() * x) : Eigen::VectorXd(full_ * x);
    else
      left -= transposed ? Eigen::VectorXd(rows_.transpose() * x) : Eigen::VectorXd(rows_ * x);
    apply_inverse(left, transposed);
    x += left;
  }
  r = x.cwiseProduct(transposed ? row_ : column_).tail(unknowns_);
  return off;
}

double ActiveSystem::solve(Eigen::VectorXd& r) const { return solve_as(r, false); }
double ActiveSystem::solve_transposed(Eigen::VectorXd& r) const { return solve_as(r, true); }

}  // namespace orthant
