// core/lcp/matrix.h — matrix of a problem: dense, compressed rows, or a Delassus operator; one access to all storages.
#pragma once

#include <orthant/core/support/reusable.h>

#include <Eigen/SparseCore>
#include <limits>
#include <type_traits>
#include <variant>
#include <vector>

namespace orthant {

inline constexpr double kInf = std::numeric_limits<double>::infinity();

/// Compressed rows: row i holds (column[k], value[k]) for start[i] ≤ k < start[i + 1], columns ascending.
/// Plain vectors, so that a matrix rebuilt at every step keeps its memory.
struct RowSparse {
  Index rows = 0, cols = 0;
  std::vector<int> start{0}, column;
  std::vector<double> value;

  using View = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>;
  View view() const {
    return {rows, cols, static_cast<Index>(value.size()), start.data(), column.data(), value.data()};
  }
  static RowSparse from(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix);

  /// use(j, A_ij) for the entries of row i.
  template <class Use> void for_each_in_row(Index i, const Use& use) const {
    for (std::size_t k = at(start[at(i)]); k < at(start[at(i) + 1]); ++k) use(Index{column[k]}, value[k]);
  }
  /// A_ij, 0 where nothing is stored. O(log of the row's entries).
  double entry(Index i, Index j) const;
};

/// A = W M⁻¹ Wᵀ + R, applied row by row and never formed (the Delassus operator of contact mechanics).
struct Delassus {
  RowSparse W;            // n × m constraint Jacobian
  Vector inverse_mass;    // m, diagonal of M⁻¹, ≥ 0
  Vector regularization;  // n, diagonal of R, ≥ 0; empty: none
};

using Matrix = std::variant<DenseMatrix, RowSparse, Delassus>;

/// Throws std::invalid_argument naming the field, the value and the rule when A is not square or its parts do not fit.
void check(const Matrix& A);

/// y ← A x, shape n; the sum runs in a fixed order, so equal input gives equal bits.
/// `scratch` takes what the operator needs in between (Delassus: m numbers).
void multiply(const Matrix& A, const Eigen::Ref<const Eigen::VectorXd>& x, Vector& y, Vector& scratch);

/// n of an n × n matrix, as stored (check() sees to it that it is square).
Index order(const Matrix& A);

/// A_ii; diag ← all of them.
double diagonal(const Matrix& A, Index i);
void diagonal(const Matrix& A, Vector& diag);

/// A_ij: stored, 0 where nothing is, or summed for an operator.
double entry(const Matrix& A, Index i, Index j);

/// y = Aᵀx, in the order of multiply() for an operator, which is symmetric.
Eigen::VectorXd multiply_transposed(const Matrix& A, const Eigen::VectorXd& x);

/// use(i, j, A_ij) for the stored entries: zeros of a dense matrix too, column by column, or row by row. Ends where
/// `use` returns false, if it returns a bool. An operator has no entries: nothing is called, and the result is false.
template <class Use> bool for_each_entry(const Matrix& A, const Use& use) {
  const auto goes_on = [&use](Index i, Index j, double value) {
    if constexpr (std::is_same_v<decltype(use(i, j, value)), bool>)
      return use(i, j, value);
    else
      return use(i, j, value), true;
  };
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) {
    for (Index j = 0; j < dense->cols(); ++j)
      for (Index i = 0; i < dense->rows(); ++i)
        if (!goes_on(i, j, (*dense)(i, j))) return true;
  } else if (const auto* rows = std::get_if<RowSparse>(&A)) {
    for (Index i = 0; i < rows->rows; ++i)
      for (std::size_t k = at(rows->start[at(i)]); k < at(rows->start[at(i) + 1]); ++k)
        if (!goes_on(i, Index{rows->column[k]}, rows->value[k])) return true;
  } else {
    return false;
  }
  return true;
}

/// The same for row i, use(j, A_ij): all entries of a dense row.
template <class Use> bool for_each_in_row(const Matrix& A, Index i, const Use& use) {
  if (const auto* dense = std::get_if<DenseMatrix>(&A))
    for (Index j = 0; j < dense->cols(); ++j) use(j, (*dense)(i, j));
  else if (const auto* rows = std::get_if<RowSparse>(&A))
    rows->for_each_in_row(i, use);
  else
    return false;
  return true;
}

/// A with the storage asked for. Where A has it already, entries and memory are kept; else empty.
template <class Storage> Storage& as(Matrix& A) {
  if (auto* stored = std::get_if<Storage>(&A)) return *stored;
  return A.emplace<Storage>();
}

/// A as a dense matrix (the Delassus operator is formed: for direct methods on small problems).
void to_dense(const Matrix& A, DenseMatrix& dense);
/// A itself where it is dense, else formed in `room`.
const DenseMatrix& dense_of(const Matrix& A, DenseMatrix& room);
/// The entries of an operator row by row, columns ascending, sums that are 0 left out. False, and nothing formed, where
/// that takes more than `most` products.
bool to_rows(const Delassus& A, RowSparse& rows, double most = kInf);
/// A itself where it is stored by rows; else its entries that are not 0, in `room`: of an operator as to_rows() has
/// them, null where that takes more than `most` products.
const RowSparse* rows_of(const Matrix& A, RowSparse& room, double most = kInf);

}  // namespace orthant
