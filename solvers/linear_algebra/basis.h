// solvers/linear_algebra/basis.h — basis factorization: a regular matrix of chosen columns, updated column by column.
//
//   Operations of a pivoting method on its basis: B x = v, Bᵀ y = v, and one column replaced at a time.
//     1. Columns with one entry (slack variables: most of a basis) are set aside, each with the row it covers; what is
//        left is a square core. Its rows and columns are scaled by powers of 2 and factorized:
//        dense_lu.h, or KLU (sparse_lu.h).   O(m³) for a dense core of m columns.
//     2. replace(k, x), x = B⁻¹ a: column k becomes a, so B ← B E with E = I except its column k, x (the product form
//        of the inverse). A solve then applies one E⁻¹ an update, O(nonzeros of x).
//     3. After `update_limit` updates, or when x_k is so small that dividing by it would lose the digits, replace()
//        refuses, and the caller factorizes again with the new column.
//   T = double, long double or 256 bits (scalars.h); a sparse core in the last two is factorized densely.
//   Sources: Dantzig & Orchard-Hays, Math. Tables Aids Comput. 8 (1954) 64-67 (product form); Chvátal, Linear
//   Programming (1983), ch. 7, 24.
#pragma once

#include <orthant/core/lcp/matrix.h>
#include <orthant/core/support/reusable.h>
#include <orthant/solvers/linear_algebra/dense_lu.h>
#include <orthant/solvers/linear_algebra/scalars.h>
#include <orthant/solvers/linear_algebra/sparse_lu.h>

#include <vector>

namespace orthant {

enum class BasisStorage { dense, sparse };
/// Sparse where A is stored by rows.
inline BasisStorage storage_of(const Matrix& A) {
  return std::holds_alternative<RowSparse>(A) ? BasisStorage::sparse : BasisStorage::dense;
}

template <class T> class Basis {  // reuse it: the second basis of a size allocates nothing (KLU: memory of its own)
 public:
  using Storage = BasisStorage;
  using View = Eigen::Ref<Eigen::Matrix<T, Eigen::Dynamic, 1>>;
  using ConstView = const Eigen::Ref<const Eigen::Matrix<T, Eigen::Dynamic, 1>>&;
  struct Missing {
    Index position, row;
  };

  /// An n × n basis to come. Once the budget, which must outlive it (null: none), is over, factorize() says false and
  /// names no column.
  void reset(Index n, Storage storage, int update_limit = 64, const Budget* budget = nullptr);

  /// A new B. columns(k, add) must call add(row, value) for the entries of column k, 0 ≤ k < n, each row at most once.
  /// False when B is singular to working precision, or not finite: missing() then says where, and solves are undefined.
  template <class Columns> bool factorize(const Columns& columns) {
    start_.assign(1, 0);
    row_.clear();
    value_.clear();
    for (Index k = 0; k < n_; ++k) {
      columns(k, [this](Index row, T value) {
        if (value == T(0)) return;
        row_.push_back(static_cast<int>(row));
        value_.push_back(value);
      });
      start_.push_back(static_cast<int>(row_.size()));
    }
    return factorize_gathered();
  }
  /// After factorize() said false: columns that depend on the others. With the unit vectors of these rows in their
  /// places B is regular. Empty when B is not finite, or sparse with a core of more than 2000 columns.
  const std::vector<Missing>& missing() const { return missing_; }

  void solve(View x);             // x ← B⁻¹ x: by row on entry, by position on return
  void solve_transposed(View y);  // y ← B⁻ᵀ y: by position on entry, by row on return

  /// Column k becomes B x. False, nothing changed, when |x_k| is too small relative to ‖x‖∞ or the updates are used up.
  bool replace(Index k, ConstView x);

  int updates() const { return static_cast<int>(eta_position_.size()); }
  /// Least share a pivot had of the largest candidate, over the factorization and the updates: about the reciprocal of
  /// what an error may have grown by.
  T pivot_ratio() const { return pivot_ratio_; }

 private:
  bool factorize_gathered();
  void gather_core();
  template <class Lu> void solve_core(Lu& lu, View x);
  Index n_ = 0;
  bool sparse_ = false;
  const Budget* budget_ = nullptr;
  int update_limit_ = 64;
  T pivot_ratio_ = 1;
  std::vector<int> start_, row_;  // the columns as given
  std::vector<T> value_;
  std::vector<Index> unit_;               // per row: position of the column that covers it alone, or −1
  std::vector<Index> core_column_;        // positions of the others
  std::vector<Index> core_row_;           // rows not covered
  std::vector<Index> place_;              // per row: its place in core_row_, or −1
  std::vector<T> row_scale_, col_scale_;  // of the core, powers of 2
  std::vector<int> low_, high_;           // least and largest exponents
  DenseLu<T> dense_;
  SparseLu klu_;
  std::vector<int> klu_start_, klu_row_;
  std::vector<double> klu_value_;
  std::vector<Missing> missing_;
  std::vector<T> core_, whole_;  // scratch
  std::vector<double> core_double_;

  std::vector<Index> eta_position_, eta_index_;  // update e: column eta_position_[e], entries [eta_start_[e], …[e + 1])
  std::vector<std::size_t> eta_start_;
  std::vector<T> eta_pivot_, eta_value_;
};

extern template class Basis<double>;
extern template class Basis<long double>;
extern template class Basis<detail::Float256>;

}  // namespace orthant
