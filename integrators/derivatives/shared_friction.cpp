#include <orthant/integrators/derivatives/shared_friction.h>

#include <Eigen/QR>

#include <cmath>

namespace orthant {

namespace {

constexpr double kSameAction = 1e-9;  // of the impulses that z makes: rounding of the least squares

}  // namespace

bool share_friction(const Eigen::MatrixXd& acts, const Eigen::VectorXd& bounds, Eigen::VectorXd& z) {
  const Eigen::VectorXd root = bounds.cwiseSqrt(), whole = acts * z;
  const Eigen::MatrixXd scaled = acts * root.asDiagonal();
  const Eigen::VectorXd shared = root.cwiseProduct(scaled.completeOrthogonalDecomposition().solve(whole));
  if (!shared.allFinite() || (acts * shared - whole).norm() > kSameAction * (acts * bounds.asDiagonal()).norm())
    return false;
  for (Eigen::Index i = 0; i < z.size(); ++i)
    if (!(std::abs(shared[i]) < (1 - kAtFrictionBound) * bounds[i])) return false;
  z = shared;
  return true;
}

bool share_friction(const Lcp& problem, std::span<const Row> rows, Eigen::Index dof, const Vector& w,
                    std::span<const double> stick, Vector& z) {
  const auto is_still = [&](std::size_t k) {
    const Friction& f = problem.friction[k];
    return f.rows == 1 && f.mu * z[f.normal] > 0 && std::abs(w[f.first]) <= stick[k];
  };
  bool any_at_bound = false;
  for (std::size_t k = 0; k < problem.friction.size() && !any_at_bound; ++k) {
    const Friction& f = problem.friction[k];
    any_at_bound = is_still(k) && std::abs(z[f.first]) >= (1 - kAtFrictionBound) * f.mu * z[f.normal];
  }
  if (!any_at_bound) return false;
  std::vector<Friction> still;
  for (std::size_t k = 0; k < problem.friction.size(); ++k)
    if (is_still(k)) still.push_back(problem.friction[k]);
  if (still.size() < 2) return false;
  const auto count = static_cast<Eigen::Index>(still.size());
  Eigen::MatrixXd acts = Eigen::MatrixXd::Zero(dof, count);
  Eigen::VectorXd bounds(count), shared(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Friction& f = still[static_cast<std::size_t>(i)];
    apply_transposed(rows[static_cast<std::size_t>(f.first)], 1, acts.col(i).data());
    shared[i] = z[f.first], bounds[i] = f.mu * z[f.normal];
  }
  if (!share_friction(acts, bounds, shared)) return false;
  for (Eigen::Index i = 0; i < count; ++i) z[still[static_cast<std::size_t>(i)].first] = shared[i];
  return true;
}

}  // namespace orthant
