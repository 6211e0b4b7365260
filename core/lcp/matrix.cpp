#include <orthant/core/lcp/matrix.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>

namespace orthant {

namespace {

template <class... Words> [[noreturn]] void refuse_matrix(const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  throw std::invalid_argument(text.str());
}

void check_rows(const char* field, const RowSparse& M) {
  if (M.rows < 0 || M.cols < 0)
    refuse_matrix("problem: ", field, " is ", M.rows, " x ", M.cols, ": sizes must be >= 0");
  if (M.start.size() != static_cast<std::size_t>(M.rows) + 1 || M.start.front() != 0 ||
      M.column.size() != M.value.size() || M.start.back() < 0 ||
      static_cast<std::size_t>(M.start.back()) != M.value.size())
    refuse_matrix("problem: ", field, ".start has ", M.start.size(), " entries: must be rows + 1 = ", M.rows + 1,
                  ", from 0 to the number of values");
  for (std::size_t i = 0; i < static_cast<std::size_t>(M.rows); ++i) {
    if (M.start[i] > M.start[i + 1] || M.start[i + 1] > M.start.back())
      refuse_matrix("problem: ", field, ".start[", i + 1, "] = ", M.start[i + 1],
                    ": must not decrease or pass the end");
    int last = -1;
    for (auto k = static_cast<std::size_t>(M.start[i]); k < static_cast<std::size_t>(M.start[i + 1]); ++k) {
      if (M.column[k] <= last || M.column[k] >= M.cols)
        refuse_matrix("problem: ", field, " row ", i, " has column ", M.column[k], ": must ascend and be below ",
                      M.cols);
      last = M.column[k];
    }
  }
}

void check_nonnegative(const char* field, const Vector& v) {
  for (Index i = 0; i < v.size(); ++i)
    if (v[i] < 0) refuse_matrix("problem: ", field, "[", i, "] = ", v[i], ": must be >= 0");
}

struct CheckMatrix {
  void operator()(const DenseMatrix& M) const {
    if (M.rows() != M.cols()) refuse_matrix("problem: A is ", M.rows(), " x ", M.cols(), ": must be square");
  }
  void operator()(const RowSparse& M) const {
    if (M.rows != M.cols) refuse_matrix("problem: A is ", M.rows, " x ", M.cols, ": must be square");
    check_rows("A", M);
  }
  void operator()(const Delassus& M) const {
    check_rows("W", M.W);
    if (M.inverse_mass.size() != M.W.cols)
      refuse_matrix("problem: inverse_mass has ", M.inverse_mass.size(), " entries: must be ", M.W.cols,
                    ", one a column of W");
    if (M.regularization.size() != 0 && M.regularization.size() != M.W.rows)
      refuse_matrix("problem: regularization has ", M.regularization.size(), " entries: must be none or ", M.W.rows,
                    ", one a row of W");
    check_nonnegative("inverse_mass", M.inverse_mass);
    check_nonnegative("regularization", M.regularization);
  }
};

}  // namespace

RowSparse RowSparse::from(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix) {
  RowSparse result;
  result.rows = matrix.rows();
  result.cols = matrix.cols();
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(matrix, i); it; ++it) {
      result.column.push_back(static_cast<int>(it.col()));
      result.value.push_back(it.value());
    }
    result.start.push_back(static_cast<int>(result.value.size()));
  }
  return result;
}

double RowSparse::entry(Index i, Index j) const {
  const auto begin = column.begin() + start[at(i)], end = column.begin() + start[at(i) + 1];
  const auto place = std::lower_bound(begin, end, static_cast<int>(j));
  return place != end && *place == j ? value[static_cast<std::size_t>(place - column.begin())] : 0.0;
}

void check(const Matrix& A) { std::visit(CheckMatrix{}, A); }

Index order(const Matrix& A) {
  struct Order {
    Index operator()(const DenseMatrix& M) const { return M.rows(); }
    Index operator()(const RowSparse& M) const { return M.rows; }
    Index operator()(const Delassus& M) const { return M.W.rows; }
  };
  return std::visit(Order{}, A);
}

void multiply(const Matrix& A, const Eigen::Ref<const Eigen::VectorXd>& x, Vector& y, Vector& scratch) {
  y.resize(order(A));
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) {
    y.setZero();
    for (Index j = 0; j < dense->cols(); ++j) y += dense->col(j) * x[j];
  } else if (const auto* sparse = std::get_if<RowSparse>(&A)) {
    y.noalias() = sparse->view() * x;
  } else {
    const auto& operand = std::get<Delassus>(A);
    scratch.resize(operand.W.cols);
    scratch.noalias() = operand.W.view().transpose() * x;
    scratch.array() *= operand.inverse_mass.array();
    y.noalias() = operand.W.view() * scratch;
    if (operand.regularization.size() != 0) y.array() += operand.regularization.array() * x.array();
  }
}

Eigen::VectorXd multiply_transposed(const Matrix& A, const Eigen::VectorXd& x) {
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) return dense->transpose() * x;
  if (const auto* sparse = std::get_if<RowSparse>(&A)) return sparse->view().transpose() * x;
  Vector y, scratch;
  multiply(A, x, y, scratch);
  return y;
}

double diagonal(const Matrix& A, Index i) {
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) return (*dense)(i, i);
  if (const auto* rows = std::get_if<RowSparse>(&A)) return rows->entry(i, i);
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  double sum = regularization.size() != 0 ? regularization[i] : 0.0;
  W.for_each_in_row(i, [&sum, &m = inverse_mass](Index k, double value) { sum += value * value * m[k]; });
  return sum;
}

double entry(const Matrix& A, Index i, Index j) {
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) return (*dense)(i, j);
  if (const auto* rows = std::get_if<RowSparse>(&A)) return rows->entry(i, j);
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  double sum = i == j && regularization.size() != 0 ? regularization[i] : 0.0;
  W.for_each_in_row(
      i, [&sum, j, &W = W, &m = inverse_mass](Index k, double value) { sum += value * W.entry(j, k) * m[k]; });
  return sum;
}

void diagonal(const Matrix& A, Vector& diag) {
  diag.resize(order(A));
  for (Index i = 0; i < diag.size(); ++i) diag[i] = diagonal(A, i);
}

void to_dense(const Matrix& A, DenseMatrix& dense) {
  const Index n = order(A);
  dense.resize(n, n);
  if (const auto* stored = std::get_if<DenseMatrix>(&A)) {
    dense = *stored;
    return;
  }
  dense.setZero();
  if (for_each_entry(A, [&dense](Index i, Index j, double value) { dense(i, j) = value; })) return;
  // A_ij = Σ_k W_ik W_jk / m_k, row i of W spread out; A_ji is the same sum, hence the same bits.
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  static thread_local Vector spread;
  spread.resize(W.cols);
  spread.setZero();
  double* const row = spread.data();
  const double* const inverse = inverse_mass.data();
  for (Index i = 0; i < n; ++i) {
    W.for_each_in_row(i, [row](Index k, double value) { row[k] = value; });
    for (Index j = 0; j <= i; ++j) {
      double sum = 0;
      W.for_each_in_row(j, [&sum, row, inverse](Index k, double value) { sum += row[k] * value * inverse[k]; });
      if (i == j && regularization.size() != 0) sum += regularization[i];
      dense(i, j) = dense(j, i) = sum;
    }
    W.for_each_in_row(i, [row](Index k, double) { row[k] = 0; });
  }
}

const DenseMatrix& dense_of(const Matrix& A, DenseMatrix& room) {
  if (const auto* stored = std::get_if<DenseMatrix>(&A)) return *stored;
  to_dense(A, room);
  return room;
}

// Row by row up to the diagonal; the rest mirrors it, as A_ji is the same sum in the same order, hence the same bits.
bool to_rows(const Delassus& A, RowSparse& rows, double most) {
  static thread_local std::vector<int> ends, uses;  // W by columns: where each ends; of each use the row
  static thread_local std::vector<double> values;
  static thread_local std::vector<double> sums;      // of the present row, and 0 again after it
  static thread_local std::vector<int> seen, found;  // of each column the last row that has it; those of this row
  static thread_local RowSparse half;
  const RowSparse& W = A.W;
  const std::size_t n = at(W.rows);
  ends.assign(at(W.cols) + 1, 0);
  for (const int k : W.column) ++ends[at(k) + 1];
  double work = 0;
  for (const int count : ends) work += static_cast<double>(count) * count;
  if (work > most) return false;
  for (std::size_t k = 1; k < ends.size(); ++k) ends[k] += ends[k - 1];
  uses.resize(W.column.size()), values.resize(W.column.size());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = at(W.start[i]); k < at(W.start[i + 1]); ++k) {
      const std::size_t place = at(ends[at(W.column[k])]++);
      uses[place] = static_cast<int>(i), values[place] = W.value[k];
    }
  sums.assign(n, 0), seen.assign(n, -1), found.resize(n);
  half.start.assign(1, 0), half.column.clear(), half.value.clear();
  const int* const row = uses.data();
  const double* const value = values.data();
  double* const sum = sums.data();
  int* const last_row = seen.data();
  for (std::size_t i = 0; i < n; ++i) {
    const int self = static_cast<int>(i);
    int* end = found.data();
    if (A.regularization.size() != 0) sum[i] = A.regularization[self];
    for (std::size_t k = at(W.start[i]); k < at(W.start[i + 1]); ++k) {
      const std::size_t column = at(W.column[k]);
      const double own = W.value[k], inverse = A.inverse_mass[W.column[k]];
      for (std::size_t l = column == 0 ? 0 : at(ends[column - 1]); row[l] < self; ++l) {  // row i itself is a use
        const int j = row[l];
        if (last_row[j] != self) last_row[j] = self, *end++ = j;
        sum[j] += own * value[l] * inverse;
      }
      sum[i] += own * own * inverse;
    }
    std::sort(found.data(), end);
    *end++ = self;
    for (const int* j = found.data(); j != end; ++j) {
      if (sum[*j] != 0) half.column.push_back(*j), half.value.push_back(sum[*j]);
      sum[*j] = 0;
    }
    half.start.push_back(static_cast<int>(half.column.size()));
  }
  rows.rows = rows.cols = W.rows;
  rows.start.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = at(half.start[i]); k < at(half.start[i + 1]); ++k) {
      ++rows.start[i + 1];
      if (half.column[k] != static_cast<int>(i)) ++rows.start[at(half.column[k]) + 1];
    }
  for (std::size_t i = 0; i < n; ++i) rows.start[i + 1] += rows.start[i];
  rows.column.resize(at(rows.start[n])), rows.value.resize(at(rows.start[n]));
  found.assign(rows.start.begin(), rows.start.end() - 1);  // of each row where its next entry goes: ascending
  const auto put = [&](std::size_t i, int j, double entry) {
    const std::size_t place = at(found[i]++);
    rows.column[place] = j, rows.value[place] = entry;
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = at(half.start[i]); k < at(half.start[i + 1]); ++k) {
      const int j = half.column[k];
      put(i, j, half.value[k]);
      if (j != static_cast<int>(i)) put(at(j), static_cast<int>(i), half.value[k]);
    }
  return true;
}

const RowSparse* rows_of(const Matrix& A, RowSparse& room, double most) {
  if (const auto* stored = std::get_if<RowSparse>(&A)) return stored;
  if (const auto* delassus = std::get_if<Delassus>(&A)) return to_rows(*delassus, room, most) ? &room : nullptr;
  const auto& dense = std::get<DenseMatrix>(A);
  room.rows = dense.rows(), room.cols = dense.cols();
  room.start.assign(1, 0), room.column.clear(), room.value.clear();
  for (Index i = 0; i < dense.rows(); ++i) {
    for (Index j = 0; j < dense.cols(); ++j)
      if (dense(i, j) != 0) room.column.push_back(static_cast<int>(j)), room.value.push_back(dense(i, j));
    room.start.push_back(static_cast<int>(room.value.size()));
  }
  return &room;
}

}  // namespace orthant
