#include <orthant/solvers/even_share.h>

#include <algorithm>

namespace orthant {
namespace {

constexpr double kWeight = 1e-3;  // of the diagonal: a tenth of the range's least eigenvalue at most, mostly
constexpr int kSteps = 50;
constexpr double kStill = 1e-14;     // of z
constexpr double kAccepted = 1e-10;  // of the data, by the judge
constexpr double kRank = 1e-10;
constexpr Index kMostRows = 300;

}  // namespace

/// Rows depend on each other: normals, or the tangents of contacts that stick.
bool EvenShare::open(const Lcp& problem) {
  const auto* A = std::get_if<DenseMatrix>(&problem.A);
  if (A == nullptr || problem.size() > kMostRows) return false;
  rank_.setThreshold(kRank);
  rank_.compute(*A);
  return rank_.rank() < problem.size();
}

bool EvenShare::improve(const Lcp& problem, Index normals, Solver& solver, Solution& s) {
  if (s.status != Status::solved || !open(problem)) return false;
  normals_ = normals;
  const auto& A = std::get<DenseMatrix>(problem.A);
  const Index n = problem.size();
  weight_ = kWeight * A.diagonal().cwiseAbs();
  for (const Friction& f : problem.friction) {
    const double mean = weight_.segment(f.first, f.rows).mean();
    weight_.segment(f.first, f.rows).setConstant(mean);
  }
  if (!(weight_.minCoeff() > 0)) return false;
  step_ = problem;
  std::get<DenseMatrix>(step_.A).diagonal() += weight_;
  trial_.z = Vector::Zero(n), last_ = Vector::Zero(n);
  double moved = kInf;
  for (int k = 0; k < kSteps; ++k) {
    step_.b = problem.b - weight_.cwiseProduct(last_);
    solver.solve(step_, trial_, k == 0 ? Start::cold : Start::warm);
    if (trial_.status != Status::solved) return false;
    refinement_.improve(step_, trial_);
    const double now = (trial_.z - last_).lpNorm<Eigen::Infinity>();
    last_ = trial_.z;
    if (now <= kStill * last_.lpNorm<Eigen::Infinity>() || (k > 5 && now >= moved)) break;  // rounding
    moved = now;
  }
  found_.z = last_;
  judge_.certify(problem, kAccepted, Claim::candidate, found_);
  if (found_.status != Status::solved ||
      found_.residual > std::max(s.residual, 1e-13 * problem.b.lpNorm<Eigen::Infinity>()))
    return false;
  s.z = found_.z, s.w = found_.w, s.residual = found_.residual;
  return true;
}

bool EvenShare::matters(const Lcp& problem, const Solution& s) const {
  constexpr double kSlides = 1e-9, kCounts = 1e-6;
  const auto& A = std::get<DenseMatrix>(problem.A);
  Eigen::VectorXd ratio = Eigen::VectorXd::Zero(problem.size());  // of a friction row's force to its normal's
  for (const Friction& f : problem.friction) {
    const double normal = s.z[f.normal], along = s.z.segment(f.first, f.rows).norm();
    if (!(normal > 0)) continue;
    if (along < (1 - kSlides) * f.mu * normal) return false;
    for (Index k = 0; k < f.rows; ++k) ratio[f.first + k] = s.z[f.first + k] / normal;
  }
  Eigen::FullPivLU<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(kRank);
  const Eigen::MatrixXd others = decomposition.compute(A.topLeftCorner(normals_, normals_)).kernel();
  Eigen::VectorXd change(problem.size());
  for (Index k = 0; k < others.cols(); ++k) {
    change.setZero(), change.head(normals_) = others.col(k);
    for (const Friction& f : problem.friction)
      for (Index t = 0; t < f.rows; ++t) change[f.first + t] = ratio[f.first + t] * change[f.normal];
    const Eigen::VectorXd by = A * change, all = A.cwiseAbs() * change.cwiseAbs();
    if ((by.cwiseAbs() - kCounts * all).maxCoeff() > 0) return true;
  }
  return false;
}

}  // namespace orthant
