#include <orthant/integrators/projection.h>

#include <limits>

namespace orthant {

namespace {

/// The largest of off(i), or NaN where one of them is.
template <class Off> double largest_off(Index rows, Off&& off) {
  double worst = 0;
  for (Index i = 0; i < rows && !std::isnan(worst); ++i)
    if (const double next = off(i); !(next <= worst)) worst = next;
  return worst;
}

}  // namespace

double joints_off(const Terms& terms, const Eigen::VectorXd& q, Extents& far) {
  constexpr double kClosed = 1e-9;
  constexpr double kAngle = 1e-6;  // [m/rad] turning rounds to 1e-16 of an angle, far less than is asked of places
  const Index rows = terms.phi.size();
  const double worst = largest_off(rows, [&](Index i) { return std::abs(terms.phi[i]); });
  if (worst <= kClosed) return worst;
  far.measure([&](Index i) {
    return std::max(std::max(std::abs(q[3 * i]), std::abs(q[3 * i + 1])), kAngle * std::abs(q[3 * i + 2]));
  });
  return largest_off(
      rows, [&](Index i) { return std::abs(terms.phi[i]) / (1 + far.of(terms.G[static_cast<std::size_t>(i)])); });
}

Projection::Projection(const System& system, bool with_joints)
    : system_(system),
      basic_(system, with_joints),
      far_(system.assembly()),
      trial_(system.dof()),
      rate_(system.joint_rows()),
      weight_(system.joint_rows()) {}

double Projection::position(double t, Terms& terms, Eigen::VectorXd& q) {
  constexpr int kIterations = 20;
  constexpr double kTolerance = 1e-15;
  set_poses(system_, t, q, terms.at);
  evaluate_joints(system_, terms);
  if (terms.phi.size() == 0) return 0;
  if (basic_.joint_rows() == 0) return terms.phi.lpNorm<Eigen::Infinity>();
  if (!basic_.factorize(system_, terms)) return std::numeric_limits<double>::infinity();
  weigh(terms, q);
  double left = mismatch(terms);
  for (int i = 0; i < kIterations && left > kTolerance; ++i) {
    rate_ = -terms.phi;
    trial_ = q;
    basic_.add_rates(rate_.data(), trial_.data());
    set_poses(system_, t, trial_, terms.at);
    evaluate_joints(system_, terms);
    const double next = mismatch(terms);
    if (!(next < left)) {  // rounding level reached, or the iteration diverges: q is the better one
      set_poses(system_, t, q, terms.at);
      evaluate_joints(system_, terms);
      break;
    }
    q.swap(trial_);
    left = next;
  }
  return terms.phi.lpNorm<Eigen::Infinity>();
}

void Projection::weigh(const Terms& terms, const Eigen::VectorXd& q) {
  far_.measure([&](Index i) { return largest_entry(q, i); });
  double far = 0, weight = 1;  // the last row's: most have the same
  for (Index i = 0; i < weight_.size(); ++i) {
    if (const double next = far_.of(terms.G[static_cast<std::size_t>(i)]); next != far)
      far = next, weight = 1 / (1 + far);
    weight_[i] = weight;
  }
}

double Projection::mismatch(const Terms& terms) const {
  return largest_off(weight_.size(), [&](Index i) { return std::abs(terms.phi[i]) * weight_[i]; });
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
    basic_.add_rates(rate_.data(), v.data());
    return missing();
  };
  constexpr int kIterations = 10;
  constexpr double kOnce = 1e-12;  // [m/s, rad/s] one solve leaves less, unless rows nearly repeat others
  double left = (missing(), correct());
  if (left <= kOnce && !system_.driven()) return left;
  const double tolerance = 1e-15 * (1 + v.lpNorm<Eigen::Infinity>());
  for (int i = 1; i < kIterations && left > tolerance; ++i) {
    const double next = correct();
    if (!(next < left)) return next;  // rounding level reached
    left = next;
  }
  return left;
}

}  // namespace orthant
