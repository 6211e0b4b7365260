#include <orthant/integrators/projection.h>

#include <limits>

namespace orthant {

Projection::Projection(const System& system, bool with_joints)
    : system_(system),
      basic_(system, with_joints),
      trial_(system.dof()),
      step_(system.dof()),
      rate_(system.joint_rows()),
      lambda_(system.joint_rows()) {}

double Projection::position(double t, Terms& terms, Eigen::VectorXd& q) {
  constexpr int kIterations = 20;
  move_poses(system_, t, q, terms.at);
  evaluate_joints(system_, terms);
  if (terms.phi.size() == 0) return 0;
  double residual = terms.phi.lpNorm<Eigen::Infinity>();
  if (basic_.joint_rows() == 0) return residual;
  if (!basic_.factorize(system_, terms)) return std::numeric_limits<double>::infinity();
  const double tolerance = 1e-15 * (1 + q.lpNorm<Eigen::Infinity>());
  for (int i = 0; i < kIterations && residual > tolerance; ++i) {
    rate_ = -terms.phi;
    basic_.solve_rates(rate_.data(), step_.data(), lambda_.data());
    trial_ = q + step_;
    move_poses(system_, t, trial_, terms.at);
    evaluate_joints(system_, terms);
    const double next = terms.phi.lpNorm<Eigen::Infinity>();
    if (!(next < residual)) {  // rounding level reached, or the iteration diverges: q is the better one
      move_poses(system_, t, q, terms.at);
      evaluate_joints(system_, terms);
      break;
    }
    q.swap(trial_);
    residual = next;
  }
  return residual;
}

double Projection::velocity(Terms& terms, Eigen::VectorXd& v) {
  if (basic_.joint_rows() == 0) return 0;
  const auto missing = [&] {
    double most = 0;
    for (Index i = 0; i < rate_.size(); ++i) {
      rate_[i] = terms.missing_rate(i, v);
      most = std::max(most, std::abs(rate_[i]));
    }
    return most;
  };
  const auto correct = [&] {
    basic_.solve_rates(rate_.data(), step_.data(), lambda_.data());
    v += step_;
    return missing();
  };
  constexpr int kIterations = 10;
  double left = (missing(), correct());
  const double tolerance = 1e-15 * (1 + v.lpNorm<Eigen::Infinity>());
  for (int i = 1; system_.driven() && i < kIterations && left > tolerance; ++i) {
    const double next = correct();
    if (!(next < left)) return next;  // rounding level reached
    left = next;
  }
  return left;
}

}  // namespace orthant
