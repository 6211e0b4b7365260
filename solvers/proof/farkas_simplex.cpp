#include <orthant/solvers/proof/farkas_simplex.h>

#include <orthant/core/lcp/judge/definite.h>

#include <Eigen/SparseLU>
#include <coin/ClpEventHandler.hpp>
#include <coin/ClpSimplex.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace orthant {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
class Stop final : public ClpEventHandler {  // polled after each iteration
 public:
  explicit Stop(const Budget& budget) : budget_(&budget) {}
  int event(Event) override { return budget_->exhausted() ? 5 : -1; }
  ClpEventHandler* clone() const override { return new Stop(*this); }  // CLP takes it over

 private:
  const Budget* budget_;
};

struct Program {
  double scale = 1;  // of z and b, so that CLP's absolute tolerance means something
  Sparse rows;       // L: lower ≤ L z ≤ upper
  std::vector<double> lower, upper;
  std::vector<Index> row_of_problem;  // −1: a friction bound
};

Program program(const Lcp& problem) {
  const Index n = problem.size();
  const Sparse A = formed(problem.A).value;
  std::vector<char> friction(at(n), 0);
  for (const Friction& f : problem.friction) friction[at(f.first)] = 1;
  Program p;
  if (const double b = problem.b.lpNorm<Eigen::Infinity>(); b > 0) p.scale = std::exp2(-std::ilogb(b));
  std::vector<Index> place(at(n), -1);
  for (Index i = 0; i < n; ++i) {
    const bool below = problem.lo[i] != -kInf, above = problem.hi[i] != kInf;
    if (friction[at(i)] != 0 || (below && above)) continue;
    place[at(i)] = static_cast<Index>(p.lower.size());
    p.lower.push_back(above ? -COIN_DBL_MAX : -problem.b[i] * p.scale);
    p.upper.push_back(below ? COIN_DBL_MAX : -problem.b[i] * p.scale);
    p.row_of_problem.push_back(i);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < n; ++j)
    for (Sparse::InnerIterator it(A, j); it; ++it)
      if (place[at(it.row())] >= 0 && it.value() != 0)
        entries.emplace_back(static_cast<int>(place[at(it.row())]), static_cast<int>(j), it.value());
  for (const Friction& f : problem.friction)
    for (const double sign : {-1.0, 1.0}) {  // μ z_n ± z_t ≥ 0
      const auto row = static_cast<int>(p.lower.size());
      entries.emplace_back(row, static_cast<int>(f.normal), f.mu);
      entries.emplace_back(row, static_cast<int>(f.first), sign);
      p.lower.push_back(0);
      p.upper.push_back(COIN_DBL_MAX);
      p.row_of_problem.push_back(-1);
    }
  p.rows.resize(static_cast<Index>(p.lower.size()), n);
  p.rows.setFromTriplets(entries.begin(), entries.end());
  return p;
}

// The multipliers of the last basis once more, to full precision; as they are where the basis does not tell.
Eigen::VectorXd polished(const ClpSimplex& clp, const Sparse& L, const Eigen::VectorXd& ray) {
  const Index m = L.rows();
  std::vector<int> place(at(m), -1);
  int size = 0;
  Index r = -1;
  for (int i = 0; i < m; ++i) {
    if (clp.getRowStatus(i) != ClpSimplex::basic)
      place[at(i)] = size++;
    else if (ray[i] != 0 && (r < 0 || std::abs(ray[i]) > std::abs(ray[r])))
      r = i;
  }
  if (r >= 0 && std::abs(ray[r]) < 1e-9 * ray.cwiseAbs().maxCoeff()) r = -1;
  std::vector<Index> columns;
  for (int j = 0; j < L.cols(); ++j)
    if (clp.getColumnStatus(j) == ClpSimplex::basic) columns.push_back(j);
  if (static_cast<int>(columns.size()) != size) return ray;
  // Row k of the system: (Lᵀu)_j = 0 for j = columns[k], or, without r, what the ray leaves in its largest column.
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  for (int k = 0; k < size; ++k)
    for (Sparse::InnerIterator it(L, columns[at(k)]); it; ++it) {
      if (place[at(it.row())] >= 0) entries.emplace_back(k, place[at(it.row())], it.value());
      if (it.row() == r) right[k] = -it.value() * (ray[r] < 0 ? -1 : 1);
    }
  if (r < 0 && size > 0) {
    const Eigen::VectorXd g = L.transpose() * ray;
    const auto largest = std::max_element(columns.begin(), columns.end(),
                                          [&](Index a, Index b) { return std::abs(g[a]) < std::abs(g[b]); });
    right[largest - columns.begin()] = g[*largest];
  }
  Eigen::VectorXd u = Eigen::VectorXd::Zero(m), solution = Eigen::VectorXd::Zero(size);
  if (size > 0) {
    Sparse B(size, size);
    B.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseLU<Sparse> lu(B);
    if (lu.info() != Eigen::Success) return ray;
    for (int step = 0; step < 4; ++step) {
      std::vector<long double> rest(right.data(), right.data() + size);
      for (Index j = 0; j < size; ++j)
        for (Sparse::InnerIterator it(B, j); it; ++it)
          rest[at(it.row())] -= static_cast<long double>(it.value()) * solution[j];
      Eigen::VectorXd residual(size);
      for (Index k = 0; k < size; ++k) residual[k] = static_cast<double>(rest[at(k)]);
      const Eigen::VectorXd change = lu.solve(residual);
      if (!change.allFinite()) return ray;
      solution += change;
    }
  }
  for (Index i = 0; i < m; ++i)
    if (place[at(i)] >= 0) u[i] = solution[place[at(i)]];
  if (r >= 0) u[r] = ray[r] < 0 ? -1 : 1;
  return u;
}

}  // namespace

bool has_simplex() { return true; }

bool propose_by_simplex(const Lcp& problem, const Budget& budget, Vector& u) {
  const Index n = problem.size();
  const Program p = program(problem);
  if (budget.exhausted()) return false;
  std::vector<double> low(at(n)), high(at(n)), cost(at(n), 0);
  for (Index j = 0; j < n; ++j) {  // costs make the start dual feasible
    low[at(j)] = problem.lo[j] == -kInf ? -COIN_DBL_MAX : problem.lo[j] * p.scale;
    high[at(j)] = problem.hi[j] == kInf ? COIN_DBL_MAX : problem.hi[j] * p.scale;
    if (problem.lo[j] != -kInf || problem.hi[j] != kInf) cost[at(j)] = problem.lo[j] != -kInf ? 1 : -1;
  }
  ClpSimplex clp;
  clp.setLogLevel(0);
  const Stop stop(budget);
  clp.passInEventHandler(&stop);
  clp.setPrimalTolerance(1e-9);
  clp.loadProblem(static_cast<int>(n), static_cast<int>(p.rows.rows()), p.rows.outerIndexPtr(), p.rows.innerIndexPtr(),
                  p.rows.valuePtr(), low.data(), high.data(), cost.data(), p.lower.data(), p.upper.data());
  clp.dual();
  if (!clp.isProvenPrimalInfeasible() || budget.exhausted()) return false;
  const std::unique_ptr<double[]> multipliers(clp.infeasibilityRay());
  if (multipliers == nullptr) return false;
  Eigen::VectorXd all = polished(clp, p.rows, Eigen::Map<Eigen::VectorXd>(multipliers.get(), p.rows.rows()));
  const double size = all.cwiseAbs().maxCoeff();
  if (!(size > 0)) return false;
  double sign = 0;  // of u: as the rows with one sign of w want it
  for (Index k = 0; k < all.size(); ++k)
    sign += all[k] * ((p.upper[at(k)] == COIN_DBL_MAX) - (p.lower[at(k)] == -COIN_DBL_MAX));
  if (sign == 0) {  // equations only: uᵀb < 0 where nothing else tells
    for (Index k = 0; k < all.size(); ++k) sign += all[k] * p.upper[at(k)];
  }
  u.resize(n);
  u.setZero();
  for (Index k = 0; k < all.size(); ++k) {
    const Index i = p.row_of_problem[at(k)];
    if (i < 0) continue;
    const double value = (sign < 0 ? -all[k] : all[k]) / size;
    const bool wrong = (value < 0 && problem.lo[i] != -kInf) || (value > 0 && problem.hi[i] != kInf);
    u[i] = wrong || std::abs(value) < 1e-15 ? 0 : value;
  }
  return true;
}

}  // namespace orthant
