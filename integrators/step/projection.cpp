#include <orthant/integrators/step/projection.h>

#include <limits>

namespace orthant {

namespace {

/// The largest of off(i), or NaN where one of them is.
template <class Off> double largest_off(Index rows, Off&& off) {
  double worst = 0, sum = 0;  // no branches: what is left after a correction is rounding, that none foresees
  for (Index i = 0; i < rows; ++i) {
    const double next = off(i);
    worst = std::max(worst, next), sum += next;
  }
  return std::isnan(sum) ? sum : worst;
}

double largest(const Eigen::VectorXd& off) {
  return largest_off(off.size(), [&](Index i) { return std::abs(off[i]); });
}

/// The largest entry of x of row i's bodies.
double far(const Terms& terms, const Eigen::VectorXd& x, Index i) {
  const Row& row = terms.G[static_cast<std::size_t>(i)];
  double most = 0;
  for (const BodyId body : {row.a, row.b})
    if (body >= 0) most = std::max(most, largest_entry(x, body));
  return most;
}

/// Some |off_i| is more than rounding of x, or NaN. worst: the largest of them.
bool misses(double worst, const Terms& terms, const Eigen::VectorXd& x, const Eigen::VectorXd& off) {
  constexpr double kTolerance = 1e-15;
  if (worst <= kTolerance) return false;
  for (Index i = 0; i < off.size(); ++i)
    if (!(std::abs(off[i]) <= kTolerance * (1 + far(terms, x, i)))) return true;
  return false;
}

}  // namespace

double off_by(const Terms& terms, const Eigen::VectorXd& x, const Eigen::VectorXd& off) {
  return largest_off(off.size(), [&](Index i) { return std::abs(off[i]) / (1 + far(terms, x, i)); });
}

double joints_off(const Terms& terms, const Eigen::VectorXd& q, Extents& far) {
  constexpr double kClosed = 1e-9;
  constexpr double kAngle = 1e-6;  // [m/rad] turning rounds to 1e-16 of an angle, far less than is asked of places
  const Index rows = terms.phi.size();
  const double worst = largest(terms.phi);
  if (worst <= kClosed) return worst;
  far.measure([&](Index i) { return std::max(largest_translation(q, i), kAngle * std::abs(rotation(q, i))); });
  return largest_off(
      rows, [&](Index i) { return std::abs(terms.phi[i]) / (1 + far.of(terms.G[static_cast<std::size_t>(i)])); });
}

Projection::Projection(const System& system, bool with_joints)
    : system_(system),
      basic_(system, with_joints),
      far_(system.assembly()),
      trial_(system.dof()),
      rate_(system.joint_rows()) {}

double Projection::position(double t, Terms& terms, Eigen::VectorXd& q, const Eigen::VectorXd* added) {
  constexpr int kMatrices = 8;
  set_poses(system_, t, q, terms.at);
  evaluate_joints(system_, terms);
  if (terms.phi.size() == 0) return 0;
  if (basic_.joint_rows() == 0) return largest(terms.phi);
  double worst = largest(terms.phi);
  for (int matrices = 0; matrices == 0 || (matrices < kMatrices && !(worst <= kJointsHold)); ++matrices) {
    if (!basic_.factorize(system_, terms, 0, 0, added)) return std::numeric_limits<double>::infinity();
    worst = approach(t, terms, q, worst);
  }
  return worst;
}

double Projection::approach(double t, Terms& terms, Eigen::VectorXd& q, double worst) {
  constexpr int kIterations = 20;
  bool more = misses(worst, terms, q, terms.phi);
  for (int i = 0; i < kIterations && more; ++i) {
    rate_ = -terms.phi;
    trial_ = q;
    basic_.add_rates(rate_.data(), trial_.data());
    set_poses(system_, t, trial_, terms.at);
    evaluate_joints(system_, terms);
    const double next = largest(terms.phi);
    more = misses(next, terms, trial_, terms.phi);
    if (more && !(off_by(terms, q, terms.phi) < off_by(terms, q, rate_))) {  // rounding, or it diverges: q is better
      set_poses(system_, t, q, terms.at);
      evaluate_joints(system_, terms);
      break;
    }
    q.swap(trial_);
    worst = next;
  }
  return worst;
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
  for (int i = 1; i < kIterations && misses(left, terms, v, rate_); ++i) {
    const double next = correct();
    if (!(next < left)) return next;  // rounding level reached
    left = next;
  }
  return left;
}

}  // namespace orthant
