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

void check_friction(const Lcp& p) {
  const Index n = p.size();
  bool ascending = true;
  for (std::size_t k = 0; k < p.friction.size(); ++k) {
    const Friction& f = p.friction[k];
    if (f.rows != 1 && f.rows != 2)
      refuse("problem: friction[", k, "].rows = ", f.rows, ": must be 1 (interval) or 2 (disc)");
    if (f.first < 0 || f.first > n - f.rows)
      refuse("problem: friction[", k, "].", f.rows == 1 ? "row" : "first", " = ", f.first, ": must be in [0, ",
             n - f.rows, "]");
    if (f.normal < 0 || f.normal >= n || (f.normal >= f.first && f.normal < f.first + f.rows))
      refuse("problem: friction[", k, "].normal = ", f.normal, ": must be another row in [0, ", n - 1, "]");
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

/// All but the matrix.
const Lcp& with_parts_of(const Lcp& problem, Lcp& room) {
  room.b = problem.b, room.lo = problem.lo, room.hi = problem.hi, room.friction = problem.friction;
  return room;
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

Lcp Lcp::standard(Matrix M, const Vector& q) {
  Lcp problem;
  problem.A = std::move(M);
  problem.b = q;
  problem.lo = Eigen::VectorXd::Zero(q.size());
  problem.hi = Eigen::VectorXd::Constant(q.size(), kInf);
  return problem;
}

void check(const Lcp& problem) {
  check(problem.A);
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

const Lcp& with_dense_matrix(const Lcp& problem, Lcp& room) {
  auto& dense = as<DenseMatrix>(room.A);
  return &dense_of(problem.A, dense) == &dense ? with_parts_of(problem, room) : problem;
}

const Lcp& with_rows(const Lcp& problem, Lcp& room) {
  auto& rows = as<RowSparse>(room.A);
  return rows_of(problem.A, rows) == &rows ? with_parts_of(problem, room) : problem;
}

bool finite(const Lcp& problem) { return std::visit(Finite{}, problem.A) && finite(problem.b); }

}  // namespace orthant
