#include <orthant/integrators/step/spatial_immobility.h>

#include <cmath>

namespace orthant {

namespace {

constexpr double kImmobileShare = 1e-12;

}  // namespace

bool immobile(const RowOf<Spatial>& row, double effective, const Eigen::VectorXd& inverse_mass) {
  return effective <= kImmobileShare * coupling(row, row, inverse_mass);
}

SpatialImmobility::SpatialImmobility(const SystemOf<Spatial>& system)
    : system_(system), terms_(system), basic_(system), change_(system.dof()), sum_(change_), sizes_(change_) {}

bool SpatialImmobility::stand(double t, const Eigen::VectorXd& q) {
  usable_ = false;
  if (system_.joint_rows() == 0) return false;
  set_poses(system_, t, q, terms_.at);
  evaluate_joint_rows(system_, terms_);
  return usable_ = basic_.factorize(system_, terms_);
}

bool SpatialImmobility::immobile(int contact) {
  if (!usable_) return false;
  terms_.closed.clear();
  add_closed(system_, contact, terms_);
  const RowOf<Spatial>& normal = terms_.closed.back().rows.normal;
  basic_.solve_row(normal, change_.data());
  return orthant::immobile(normal, apply(normal, change_.data()), system_.inverse_mass());
}

double SpatialImmobility::rate() {
  if (!system_.driven()) return 0;
  sum_.setZero(), sizes_.setZero();
  add(terms_.closed.back().rows.normal, 1);
  return rate_of_sum(terms_.joint_rate);
}

double SpatialImmobility::gap() const { return gap_of(system_, {}, terms_.closed.back().contact, terms_.at); }

bool SpatialImmobility::begin(const TermsOf<Spatial>& terms) {
  sum_.setZero(), sizes_.setZero(), free_ = 0;
  return usable_ = system_.joint_rows() > 0 && basic_.factorize(system_, terms);
}

void SpatialImmobility::add(const RowOf<Spatial>& row, double weight) {
  apply_transposed(row, weight, sum_.data());
  each_entry(row, [&](Index i, double entry) { sizes_[i] += std::abs(weight * entry); });
  free_ += weight * weight * coupling(row, row, system_.inverse_mass());
}

std::optional<double> SpatialImmobility::rate_of_immobile(const TermsOf<Spatial>& terms) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(system_.joint_rows());
  load_.resize(none.size());
  basic_.solve(sum_.data(), none.data(), change_.data(), load_.data());
  if (!(sum_.dot(change_) <= kImmobileShare * free_)) return {};
  return system_.driven() ? rate_of_sum(terms.joint_rate) : 0;
}

/// [m/s] J v of the combination; 0: rounding of the speeds of its bodies, and of the fastest one.
double SpatialImmobility::rate_of_sum(const Eigen::VectorXd& joint_rate) {
  constexpr double kOfSpeed = 1e-9, kOfFastest = 256 * 0x1p-52;
  change_.setZero();  // a velocity that the joints allow
  basic_.add_rates(joint_rate.data(), change_.data());
  double rounding = kOfFastest * sizes_.norm() * change_.lpNorm<Eigen::Infinity>();
  for (Index b = 0; b < system_.bodies(); ++b)
    rounding += kOfSpeed * (translation<Spatial>(sizes_, b).norm() * translation<Spatial>(change_, b).norm() +
                            rotation<Spatial>(sizes_, b).norm() * rotation<Spatial>(change_, b).norm());
  const double rate = sum_.dot(change_);
  return std::abs(rate) > rounding ? rate : 0;
}

}  // namespace orthant
