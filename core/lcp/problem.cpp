#include <orthant/core/lcp/problem.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace orthant {

namespace {

template <class... Words> [[noreturn]] void refuse(const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  throw std::invalid_argument(text.str());
}

void check_size(const char* field, Index size, Index n) {
  if (size != n) refuse("problem: ", field, " has ", size, " entries: must be ", n, ", one a row of A");
}

void check_rows(const char* field, const RowSparse& M) {
  if (M.rows < 0 || M.cols < 0) refuse("problem: ", field, " is ", M.rows, " x ", M.cols, ": sizes must be >= 0");
  if (M.start.size() != static_cast<std::size_t>(M.rows) + 1 || M.start.front() != 0 ||
      M.column.size() != M.value.size() || M.start.back() < 0 ||
      static_cast<std::size_t>(M.start.back()) != M.value.size())
    refuse("problem: ", field, ".start has ", M.start.size(), " entries: must be rows + 1 = ", M.rows + 1,
           ", from 0 to the number of values");
  for (std::size_t i = 0; i < static_cast<std::size_t>(M.rows); ++i) {
    if (M.start[i] > M.start[i + 1] || M.start[i + 1] > M.start.back())
      refuse("problem: ", field, ".start[", i + 1, "] = ", M.start[i + 1], ": must not decrease or pass the end");
    int last = -1;
    for (auto k = static_cast<std::size_t>(M.start[i]); k < static_cast<std::size_t>(M.start[i + 1]); ++k) {
      if (M.column[k] <= last || M.column[k] >= M.cols)
        refuse("problem: ", field, " row ", i, " has column ", M.column[k], ": must ascend and be below ", M.cols);
      last = M.column[k];
    }
  }
}

void check_nonnegative(const char* field, const Vector& v) {
  for (Index i = 0; i < v.size(); ++i)
    if (v[i] < 0) refuse("problem: ", field, "[", i, "] = ", v[i], ": must be >= 0");
}

struct CheckMatrix {
  void operator()(const DenseMatrix& M) const {
    if (M.rows() != M.cols()) refuse("problem: A is ", M.rows(), " x ", M.cols(), ": must be square");
  }
  void operator()(const RowSparse& M) const {
    if (M.rows != M.cols) refuse("problem: A is ", M.rows, " x ", M.cols, ": must be square");
    check_rows("A", M);
  }
  void operator()(const Delassus& M) const {
    check_rows("W", M.W);
    if (M.inverse_mass.size() != M.W.cols)
      refuse("problem: inverse_mass has ", M.inverse_mass.size(), " entries: must be ", M.W.cols,
             ", one a column of W");
    if (M.regularization.size() != 0 && M.regularization.size() != M.W.rows)
      refuse("problem: regularization has ", M.regularization.size(), " entries: must be none or ", M.W.rows,
             ", one a row of W");
    check_nonnegative("inverse_mass", M.inverse_mass);
    check_nonnegative("regularization", M.regularization);
  }
};

void check_friction(const Lcp& p) {
  const Index n = p.size();
  bool ascending = true;
  for (std::size_t k = 0; k < p.friction.size(); ++k) {
    const Friction& f = p.friction[k];
    if (f.rows != 1 && f.rows != 2)
      refuse("problem: friction[", k, "].rows = ", f.rows, ": must be 1 (interval) or 2 (disc)");
    if (f.first < 0 || f.first > n - f.rows)
      refuse("problem: friction[", k, "].", f.rows == 1 ? "row" : "first", " = ", f.first, ": must be in [0, ",
             n - f.rows + 1, ")");
    if (f.normal < 0 || f.normal >= n || (f.normal >= f.first && f.normal < f.first + f.rows))
      refuse("problem: friction[", k, "].normal = ", f.normal, ": must be another row in [0, ", n, ")");
    if (!(f.mu >= 0 && f.mu < kInf)) refuse("problem: friction[", k, "].mu = ", f.mu, ": must be finite and >= 0");
    for (Index row = f.first; row < f.first + f.rows; ++row)
      if (p.lo[row] != -kInf || p.hi[row] != kInf)
        refuse("problem: friction row ", row, " has bounds [", p.lo[row], ", ", p.hi[row],
               "]: must be -inf and inf, friction sets them");
    if (!(p.lo[f.normal] >= 0))
      refuse("problem: row ", f.normal, ", normal of friction row ", f.first, ", has the lower bound ", p.lo[f.normal],
             ": must be >= 0");
    if (k > 0) ascending = ascending && p.friction[k - 1].first + p.friction[k - 1].rows <= f.first;
  }
  if (ascending) return;  // no row twice; and no normal is a friction row, because that has lo = −∞
  std::vector<std::size_t> of(static_cast<std::size_t>(n), p.friction.size());
  for (std::size_t k = 0; k < p.friction.size(); ++k)
    for (Index row = p.friction[k].first; row < p.friction[k].first + p.friction[k].rows; ++row) {
      std::size_t& before = of[static_cast<std::size_t>(row)];
      if (before != p.friction.size())
        refuse("problem: friction[", k, "] has row ", row, ": must not occur twice (also friction[", before, "])");
      before = k;
    }
}

// x · 0 is 0 for a finite x and NaN for any other: sums without branches, four of them so that none waits for the last.
bool finite(const double* x, std::size_t size) {
  double sum = 0;
  std::size_t i = 0;
  if (size >= 16) {
    double part[4] = {0, 0, 0, 0};
    for (; i + 4 <= size; i += 4)
      for (std::size_t k = 0; k < 4; ++k) part[k] += 0.0 * x[i + k];
    sum = part[0] + part[1] + part[2] + part[3];
  }
  for (; i < size; ++i) sum += 0.0 * x[i];
  return sum == 0.0;
}
bool finite(const Vector& v) { return finite(v.data(), static_cast<std::size_t>(v.size())); }

struct Finite {
  bool operator()(const DenseMatrix& M) const { return finite(M.data(), static_cast<std::size_t>(M.size())); }
  bool operator()(const RowSparse& M) const { return finite(M.value.data(), M.value.size()); }
  bool operator()(const Delassus& M) const {
    return (*this)(M.W) && finite(M.inverse_mass) && finite(M.regularization);
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

Lcp Lcp::standard(Matrix M, const Vector& q) {
  Lcp problem;
  problem.A = std::move(M);
  problem.b = q;
  problem.lo = Eigen::VectorXd::Zero(q.size());
  problem.hi = Eigen::VectorXd::Constant(q.size(), kInf);
  return problem;
}

void check(const Matrix& A) { std::visit(CheckMatrix{}, A); }

void check(const Lcp& problem) {
  std::visit(CheckMatrix{}, problem.A);
  const Index n = order(problem.A);
  check_size("b", problem.b.size(), n);
  check_size("lo", problem.lo.size(), n);
  check_size("hi", problem.hi.size(), n);
  for (Index i = 0; i < n; ++i)
    if (!(problem.lo[i] <= problem.hi[i] && problem.lo[i] < kInf && problem.hi[i] > -kInf))
      refuse("problem: row ", i, " has bounds [", problem.lo[i], ", ", problem.hi[i],
             "]: must be lower <= upper, lower < inf, upper > -inf");
  check_friction(problem);
}

bool finite(const Lcp& problem) { return std::visit(Finite{}, problem.A) && finite(problem.b); }

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

double diagonal(const Matrix& A, Index i) {
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) return (*dense)(i, i);
  const auto* delassus = std::get_if<Delassus>(&A);
  const RowSparse& M = delassus ? delassus->W : std::get<RowSparse>(A);
  const auto row = static_cast<std::size_t>(i);
  double sum = delassus && delassus->regularization.size() != 0 ? delassus->regularization[i] : 0.0;
  for (auto k = static_cast<std::size_t>(M.start[row]); k < static_cast<std::size_t>(M.start[row + 1]); ++k) {
    if (delassus)
      sum += M.value[k] * M.value[k] * delassus->inverse_mass[M.column[k]];
    else if (M.column[k] == i)
      sum = M.value[k];
  }
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
  if (const auto* sparse = std::get_if<RowSparse>(&A)) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i)
      for (auto k = static_cast<std::size_t>(sparse->start[i]); k < static_cast<std::size_t>(sparse->start[i + 1]); ++k)
        dense(static_cast<Index>(i), sparse->column[k]) = sparse->value[k];
    return;
  }
  // A_ij = Σ_k W_ik W_jk / m_k, row i of W spread out; A_ji is the same sum, hence the same bits.
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  static thread_local Vector spread;
  spread.resize(W.cols);
  spread.setZero();
  double* const row = spread.data();
  const double* const inverse = inverse_mass.data();
  const auto each = [&rows = W](Index i, auto&& use) {
    for (int k = rows.start[static_cast<std::size_t>(i)]; k < rows.start[static_cast<std::size_t>(i) + 1]; ++k)
      use(rows.column[static_cast<std::size_t>(k)], rows.value[static_cast<std::size_t>(k)]);
  };
  for (Index i = 0; i < n; ++i) {
    each(i, [row](int k, double value) { row[k] = value; });
    for (Index j = 0; j <= i; ++j) {
      double sum = 0;
      each(j, [&sum, row, inverse](int k, double value) { sum += row[k] * value * inverse[k]; });
      if (i == j && regularization.size() != 0) sum += regularization[i];
      dense(i, j) = dense(j, i) = sum;
    }
    each(i, [row](int k, double) { row[k] = 0; });
  }
}

bool to_rows(const Delassus& A, RowSparse& rows, double most) {
  static thread_local std::vector<int> end, row;  // W by columns: where each ends; of each use of a body, the row
  static thread_local std::vector<double> value, sum;
  static thread_local std::vector<char> met;
  const RowSparse& W = A.W;
  const auto u = [](auto i) { return static_cast<std::size_t>(i); };
  end.assign(u(W.cols) + 1, 0);
  for (const int k : W.column) ++end[u(k) + 1];
  double work = 0;
  for (const int uses : end) work += static_cast<double>(uses) * uses;
  if (work > most) return false;
  for (std::size_t k = 1; k < end.size(); ++k) end[k] += end[k - 1];
  row.resize(W.column.size()), value.resize(W.column.size());
  for (Index i = 0; i < W.rows; ++i)
    for (std::size_t k = u(W.start[u(i)]); k < u(W.start[u(i) + 1]); ++k) {
      const auto place = u(end[u(W.column[k])]++);
      row[place] = static_cast<int>(i), value[place] = W.value[k];
    }
  sum.assign(u(W.rows), 0);  // of the present row, and 0 again after it
  met.assign(u(W.rows), 0);
  rows.rows = rows.cols = W.rows;
  rows.start.assign(1, 0), rows.column.clear(), rows.value.clear();
  for (Index i = 0; i < W.rows; ++i) {
    const auto begin = rows.column.size();
    const auto add = [&](int j, double term) {
      if (!met[u(j)]) met[u(j)] = 1, rows.column.push_back(j);
      sum[u(j)] += term;
    };
    if (A.regularization.size() != 0) add(static_cast<int>(i), A.regularization[i]);
    for (std::size_t k = u(W.start[u(i)]); k < u(W.start[u(i) + 1]); ++k) {
      const auto body = u(W.column[k]);
      for (std::size_t l = body == 0 ? 0 : u(end[body - 1]); l < u(end[body]); ++l)
        add(row[l], W.value[k] * value[l] * A.inverse_mass[W.column[k]]);  // A_ji has the same bits
    }
    std::sort(rows.column.begin() + static_cast<std::ptrdiff_t>(begin), rows.column.end());
    auto kept = begin;
    for (auto k = begin; k < rows.column.size(); ++k) {
      const int j = rows.column[k];
      if (sum[u(j)] != 0) rows.column[kept++] = j, rows.value.push_back(sum[u(j)]);
      sum[u(j)] = 0, met[u(j)] = 0;
    }
    rows.column.resize(kept);
    rows.start.push_back(static_cast<int>(kept));
  }
  return true;
}

}  // namespace orthant
