#include <orthant/integrators/event_driven/refined_solver.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr Index kMostRefined = 64;
constexpr int kRefinements = 20;

bool in_disc(const Lcp& problem, Index row) {
  return std::ranges::any_of(problem.friction,
                             [&](const Friction& f) { return row >= f.first && row < f.first + f.rows; });
}

}  // namespace

/// The largest of |z − P(z − w/a)|, in units of w.
double RefinedSolver::residual(const Lcp& problem, const DenseMatrix& A, const Vector& z) const {
  const Vector w = A * z + problem.b;
  double most = 0;
  for (Index i = 0; i < z.size(); ++i)
    if (!in_disc(problem, i)) {
      const double a = std::max(A(i, i), 1e-300);
      most = std::max(most, a * std::abs(z[i] - std::clamp(z[i] - w[i] / a, problem.lo[i], problem.hi[i])));
    }
  for (const Friction& f : problem.friction) {
    const double a = std::max(A.diagonal().segment(f.first, f.rows).maxCoeff(), 1e-300);
    const double radius = f.mu * std::max(z[f.normal], 0.0);
    const Vector force = z.segment(f.first, f.rows);
    Vector to = force - w.segment(f.first, f.rows) / a;
    if (to.norm() > radius) to *= radius / to.norm();
    most = std::max(most, a * (force - to).norm());
  }
  return most;
}

/// One Newton step on the pattern of z.
bool RefinedSolver::step(const Lcp& problem, const DenseMatrix& A, Vector& z) {
  const Index n = z.size();
  const Vector w = A * z + problem.b;
  std::vector<Index> basic;
  Eigen::MatrixXd to_z = Eigen::MatrixXd::Zero(n, n);
  std::vector<Index> column(static_cast<std::size_t>(n), -1);
  const auto free = [&](Index i) {
    column[static_cast<std::size_t>(i)] = static_cast<Index>(basic.size());
    to_z(i, static_cast<Index>(basic.size())) = 1;
    basic.push_back(i);
  };
  for (Index i = 0; i < n; ++i) {
    if (in_disc(problem, i)) continue;
    const double a = A(i, i), at = a * z[i] - w[i];
    if (at <= a * problem.lo[i])
      z[i] = problem.lo[i];
    else if (at >= a * problem.hi[i])
      z[i] = problem.hi[i];
    else
      free(i);
  }
  for (const Friction& f : problem.friction) {
    const Index normal = column[static_cast<std::size_t>(f.normal)];
    const Vector slip = w.segment(f.first, f.rows), force = z.segment(f.first, f.rows);
    const double a = A.diagonal().segment(f.first, f.rows).maxCoeff(), radius = f.mu * z[f.normal];
    if (normal < 0) {
      z.segment(f.first, f.rows).setZero();
    } else if ((force - slip / a).norm() <= radius) {
      for (Index k = 0; k < f.rows; ++k) free(f.first + k);
    } else if (slip.norm() > 0) {
      z.segment(f.first, f.rows) = -radius / slip.norm() * slip;
      to_z.col(normal).segment(f.first, f.rows) = -f.mu / slip.norm() * slip;
    } else {
      return false;
    }
  }
  const auto m = static_cast<Index>(basic.size());
  if (m == 0) return false;
  const Vector now = A * z + problem.b;
  Eigen::MatrixXd AB(m, m);
  Eigen::VectorXd missing(m);
  const Eigen::MatrixXd all = A * to_z.leftCols(m);
  for (Index i = 0; i < m; ++i)
    AB.row(i) = all.row(basic[static_cast<std::size_t>(i)]), missing[i] = -now[basic[static_cast<std::size_t>(i)]];
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(1e-10);
  decomposition.compute(AB);
  z += to_z.leftCols(m) * decomposition.solve(missing);
  return z.allFinite();
}

Claim RefinedSolver::run(const Lcp& problem, Solution& s, Start start) {
  inner_.z = s.z;
  solver_->solve(problem, inner_, start);
  s.z = inner_.z;
  const Claim claim = handed_on(inner_, s);
  const auto* A = std::get_if<DenseMatrix>(&problem.A);
  if (!has_answer(inner_.status) || A == nullptr || s.z.size() > kMostRefined || s.z.size() == 0) return claim;
  double least = residual(problem, *A, s.z);
  Vector z = s.z;
  for (int i = 0; i < kRefinements && least > 0; ++i) {
    if (!step(problem, *A, z)) break;
    const double now = residual(problem, *A, z);
    if (!(now < least)) break;
    least = now, s.z = z;
  }
  return claim;
}

}  // namespace orthant
