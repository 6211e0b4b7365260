#include <orthant/solvers/factorization_count.h>
#include <orthant/solvers/linear_algebra/dense_cholesky.h>
#include <orthant/solvers/linear_algebra/dense_lu.h>
#include <orthant/solvers/linear_algebra/principal_block.h>
#include <orthant/solvers/linear_algebra/scaling.h>
#include <orthant/solvers/linear_algebra/sparse_budget.h>
#include <orthant/solvers/linear_algebra/sparse_cholesky.h>

#include <Eigen/LU>
#include <Eigen/UmfPackSupport>

#include <algorithm>
#include <array>
#include <limits>

namespace orthant {
namespace {

constexpr double kGrowth = 1e4;

bool over(const Budget* budget) { return budget != nullptr && budget->exhausted(); }

/// Pivots below this part of the largest are what rounding leaves of a singular block of m rows. The entries of a shift
/// span many powers of ten by intention: nothing but 0 is small then.
double zero(Index m, const Vector* shift) {
  return shift != nullptr ? 0 : static_cast<double>(m) * 2 * std::numeric_limits<double>::epsilon();
}

}  // namespace

struct PrincipalBlock::Dense {
  DenseMatrix formed;
  const DenseMatrix* A = nullptr;
  bool symmetric = false;
  detail::Scaling scaling;  // so that "singular" does not depend on units
  DenseCholesky cholesky;
  DenseLu<double> partial;
  Eigen::FullPivLU<Eigen::MatrixXd> complete;
  enum class Kind { cholesky, partial, complete } kind = Kind::partial;
  const Vector* shift = nullptr;
  const Budget* budget = nullptr;
  Vector rhs;

  void load(const Matrix& matrix) {
    A = &dense_of(matrix, formed);
    scaling.fit(*A);
    symmetric = scaling.row == scaling.col;
    for (Index j = 0; j < A->cols() && symmetric; ++j)
      for (Index i = 0; i < j && symmetric; ++i) symmetric = (*A)(i, j) == (*A)(j, i);
  }
  /// The whole block, or its lower triangle alone.
  template <class Block> void fill(const std::vector<Index>& F, Block& block, bool lower) const {
    for (Index j = 0; j < block.cols(); ++j) {
      const double* const column = A->data() + F[at(j)] * A->rows();
      const double scale = scaling.col[F[at(j)]];
      for (Index i = lower ? j : 0; i < block.rows(); ++i)
        block(i, j) = column[F[at(i)]] * scaling.row[F[at(i)]] * scale;
    }
    for (Index i = 0; shift != nullptr && i < block.rows(); ++i)
      block(i, i) += (*shift)[F[at(i)]] * scaling.row[F[at(i)]] * scaling.col[F[at(i)]];
  }
  bool factorize(const std::vector<Index>& F) {
    const Index m = static_cast<Index>(F.size());
    if (m == 0) return true;
    if (symmetric) {
      kind = Kind::cholesky;
      cholesky.A.resize(m, m);
      fill(F, cholesky.A, true);
      if (cholesky.factorize(zero(m, shift))) return true;
      if (over(budget)) return false;
    }
    kind = Kind::partial;
    DenseLu<double>::Dense block(partial.reset(m), m, m);
    fill(F, block, false);
    if (!block.allFinite()) return false;
    const double size = block.cwiseAbs().maxCoeff();
    const bool regular = partial.factorize(zero(m, shift) * size, budget) == m;
    if (block.cwiseAbs().maxCoeff() <= kGrowth * size) return regular;
    if (over(budget)) return false;
    kind = Kind::complete;  // partial pivoting lets entries grow, up to 2ᵐ⁻¹ (Wilkinson): complete pivoting does not
    fill(F, block, false);
    complete.compute(block);
    return complete.isInvertible();
  }
  void solve(const std::vector<Index>& F, const Vector& r, Vector& x, bool refine) {
    const Index m = r.size();
    x.resize(m);
    x.setZero();
    rhs.resize(m);
    for (int round = 0; round < (refine ? 2 : 1); ++round) {
      for (Index i = 0; i < m; ++i) rhs[i] = r[i];
      if (round > 0) subtract_product(F, x);
      for (Index i = 0; i < m; ++i) rhs[i] *= scaling.row[F[at(i)]];
      if (m > 0) apply();
      for (Index i = 0; i < m; ++i) x[i] += rhs[i] * scaling.col[F[at(i)]];
    }
  }
  /// rhs ← rhs − (A_FF + D) x, in long double. Four rows at once: neighbours in a column are read together,
  /// a third of the time of row after row.
  void subtract_product(const std::vector<Index>& F, const Vector& x) {
    const Index m = x.size();
    constexpr Index kRows = 4;
    for (Index first = 0; first < m; first += kRows) {
      const Index count = std::min(kRows, m - first);
      std::array<Index, kRows> row{};
      std::array<long double, kRows> sum{};
      for (Index k = 0; k < kRows; ++k) {
        const Index i = first + std::min(k, count - 1);
        row[at(k)] = F[at(i)], sum[at(k)] = rhs[i];
      }
      for (Index j = 0; j < m; ++j) {
        const double* const column = A->data() + F[at(j)] * A->rows();
        const long double by = x[j];
        for (Index k = 0; k < kRows; ++k) sum[at(k)] -= column[row[at(k)]] * by;
      }
      for (Index k = 0; k < count; ++k) {
        if (shift != nullptr) sum[at(k)] -= static_cast<long double>((*shift)[row[at(k)]]) * x[first + k];
        rhs[first + k] = static_cast<double>(sum[at(k)]);
      }
    }
  }
  void apply() {
    switch (kind) {
      case Kind::cholesky:
        cholesky.solve(rhs);
        break;
      case Kind::partial:
        partial.solve(rhs.data());
        break;
      case Kind::complete:
        rhs = complete.solve(rhs).eval();
    }
  }
};

struct PrincipalBlock::Sparse {
  const RowSparse* A = nullptr;
  bool symmetric = false, positive = false;
  RowSparse block;
  SparseCholesky cholesky;
  Eigen::SparseMatrix<double> columns;
  Eigen::UmfPackLU<Eigen::SparseMatrix<double>> lu;
  std::vector<int> position;       // row of A → row of the block, or −1
  std::vector<int> start, column;  // the pattern that `lu` was last analysed for
  double operations = -1;          // that a factorization of this pattern takes; −1: not predicted yet
  const Budget* budget = nullptr;
  Vector rhs;

  void load(const RowSparse& matrix) {
    A = &matrix;
    // Row by row, the entries (i, j) met in column j are the next ones of row j when A is symmetric.
    position.assign(A->start.begin(), A->start.end());
    symmetric = true;
    for (Index i = 0; i < A->rows && symmetric; ++i)
      for (int k = A->start[at(i)]; k < A->start[at(i + 1)] && symmetric; ++k) {
        const std::size_t j = at(A->column[at(k)]);
        const int mirrored = position[j]++;
        symmetric =
            mirrored < A->start[j + 1] && A->column[at(mirrored)] == i && A->value[at(mirrored)] == A->value[at(k)];
      }
  }
  bool factorize(const std::vector<Index>& F, const Vector* shift) {
    block.rows = block.cols = static_cast<Index>(F.size());
    position.assign(at(A->rows), -1);
    for (std::size_t k = 0; k < F.size(); ++k) position[at(F[k])] = static_cast<int>(k);
    block.start.assign(1, 0), block.column.clear(), block.value.clear();
    for (const Index i : F) {
      double add = shift != nullptr ? (*shift)[i] : 0;
      bool placed = shift == nullptr;  // a shift needs the diagonal in the pattern
      const int row = position[at(i)];
      const auto put = [this](int j, double value) { block.column.push_back(j), block.value.push_back(value); };
      for (std::size_t k = at(A->start[at(i)]); k < at(A->start[at(i + 1)]); ++k) {
        const int j = position[at(A->column[k])];
        if (j < 0) continue;
        if (!placed && j > row) put(row, add), placed = true;
        put(j, A->value[k] + (!placed && j == row ? add : 0.0));
        placed = placed || j == row;
      }
      if (!placed) put(row, add);
      block.start.push_back(static_cast<int>(block.value.size()));
    }
    positive = F.empty() || (symmetric && cholesky.factorize(block, zero(block.rows, shift), budget));
    if (positive) return true;
    if (over(budget)) return false;
    columns = block.view();
    if (start != block.start || column != block.column) {
      start.clear(), operations = -1;
      if (!affordable()) return false;
      lu.analyzePattern(columns);
      if (lu.info() != Eigen::Success) return start.clear(), false;
      start = block.start, column = block.column;
    }
    if (!affordable()) return false;
    lu.factorize(columns);
    return lu.info() == Eigen::Success;
  }
  bool affordable() {
    if (budget == nullptr || !budget->timed()) return true;
    const auto rows = static_cast<int>(block.rows);
    if (operations < 0) {
      if (!affords_ordering(budget, rows, columns.outerIndexPtr(), columns.innerIndexPtr(), 1 + kUmfpackOrderings))
        return false;
      operations = factorization_cost(rows, columns.outerIndexPtr(), columns.innerIndexPtr());
    }
    return budget->affords(operations);
  }
  void solve(const Vector& r, Vector& x, bool refine) {
    x = r;
    apply(x);
    if (!refine) return;
    rhs = r - block.view() * x;
    apply(rhs);
    x += rhs;
  }
  void apply(Vector& x) {
    if (!positive)
      x = lu.solve(x).eval();
    else if (!cholesky.solve(x))
      x.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
};

PrincipalBlock::PrincipalBlock() = default;
PrincipalBlock::~PrincipalBlock() = default;

void PrincipalBlock::load(const Matrix& A, const Budget* budget) {
  const auto* sparse = std::get_if<RowSparse>(&A);
  is_sparse_ = sparse != nullptr;
  usable_ = false;
  budget_ = budget;
  if (is_sparse_) {
    if (!sparse_) sparse_ = std::make_unique<Sparse>();
    sparse_->budget = budget;
    sparse_->load(*sparse);
  } else {
    if (!dense_) dense_ = std::make_unique<Dense>();
    dense_->budget = budget;
    dense_->load(A);
  }
}

bool PrincipalBlock::factorize(const std::vector<Index>& F, const Vector* shift) {
  if (usable_ && shift == nullptr && F == F_) return true;
  if (over(budget_)) return false;
  F_ = F;
  count_factorization(static_cast<Index>(F.size()));
  if (!is_sparse_) dense_->shift = shift;
  const bool regular = is_sparse_ ? sparse_->factorize(F, shift) : dense_->factorize(F);
  usable_ = regular && shift == nullptr;
  return regular;
}

void PrincipalBlock::solve(const Vector& r, Vector& x, bool refine) {
  if (is_sparse_)
    sparse_->solve(r, x, refine);
  else
    dense_->solve(F_, r, x, refine);
}

}  // namespace orthant
