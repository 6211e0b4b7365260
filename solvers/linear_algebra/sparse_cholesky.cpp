#include <orthant/solvers/linear_algebra/sparse_budget.h>
#include <orthant/solvers/linear_algebra/sparse_cholesky.h>

namespace orthant {

bool SparseCholesky::factorize(const RowSparse& A, double zero, const Budget* budget) {
  if (A.rows == 0) return true;
  if (A.value.empty()) return false;
  const SymmetricColumns columns{A.start, A.column, A.value};  // its compressed rows are its compressed columns
  if (A.start != start_ || A.column != column_) {
    if (!affords_ordering(budget, static_cast<int>(A.rows), A.start.data(), A.column.data())) return false;
    start_.clear();
    if (!factor_.analyse(columns)) return false;
    start_ = A.start, column_ = A.column;
  }
  const double operations = 2 * factor_.operations();  // as an LU factorization's
  if (budget != nullptr && !budget->affords(operations)) return false;
  return factor_.factorize(columns, zero);
}

bool SparseCholesky::solve(Vector& x) {
  return x.size() == 0 || factor_.solve({x.data(), static_cast<std::size_t>(x.size())});
}

}  // namespace orthant
