#include <orthant/integrators/step/immobility.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kKnown = 256 * 0x1p-52;

}  // namespace

Immobility::Immobility(const System& system)
    : system_(system),
      terms_(system),
      basic_(system),
      gyration_(system.bodies()),
      sum_(Eigen::VectorXd::Zero(system.dof())),
      sizes_(sum_),
      left_(sum_),
      change_(sum_),
      none_(Eigen::VectorXd::Zero(system.joint_rows())),
      load_(none_),
      more_(none_) {
  const Eigen::VectorXd& m = system.inverse_mass();
  for (Index b = 0; b < gyration_.size(); ++b) gyration_[b] = std::sqrt(m[kBlock * b] / rotation(m, b));
}

bool Immobility::stand(double t, const Eigen::VectorXd& q, const std::vector<Pair>& pairs) {
  set_poses(system_, t, q, terms_.at);
  terms_.pairs = pairs;
  evaluate_joint_rows(system_, terms_);
  return factorize();
}

bool Immobility::stand(const Kinematics& at) {
  terms_.at.pose = at.pose, terms_.at.t = at.t;
  evaluate_joint_rows(system_, terms_);
  return factorize();
}

bool Immobility::stand(const Terms& terms) {
  if (terms.at.pose.size() != terms_.at.pose.size() || terms.G.size() != terms_.G.size() ||
      terms.joint_rate.size() != terms_.joint_rate.size())
    return false;
  terms_.at.pose = terms.at.pose, terms_.at.t = terms.at.t;
  terms_.G = terms.G, terms_.joint_rate = terms.joint_rate;
  return factorize();
}

bool Immobility::factorize() {
  usable_ = basic_.factorize(system_, terms_);
  return usable_;
}

ContactRows Immobility::rows(int contact) {
  terms_.closed.clear();
  add_closed(system_, contact, terms_);
  return terms_.closed.back().rows;
}

double Immobility::gap(int contact) {
  evaluate_gaps(system_, terms_);
  return terms_.gap[contact];
}

double Immobility::effective(const Row& row) {
  basic_.solve_row(row, change_.data());
  return apply(row, change_.data());
}

bool Immobility::suspicious(const Row& row, double effective, const Eigen::VectorXd& inverse_mass) {
  constexpr double kSmall = 1e-2;
  return effective <= kSmall * coupling(row, row, inverse_mass);
}

void Immobility::begin() { sum_.setZero(), sizes_.setZero(); }

void Immobility::add(const Row& row, double weight) {
  apply_transposed(row, weight, sum_.data());
  measure(row, weight);
}

void Immobility::measure(const Row& row, double weight) {
  each_entry(row, [&](Index i, double entry) { sizes_[i] += std::abs(weight * entry); });
}

Immobility::Verdict Immobility::judge() {
  constexpr int kPasses = 3;
  if (!usable_) return {};
  const auto joints = static_cast<std::size_t>(load_.size());
  left_ = sum_;
  load_.setZero();
  for (int pass = 0; pass < kPasses && joints > 0; ++pass) {
    basic_.solve(left_.data(), none_.data(), change_.data(), more_.data());
    load_ += more_;
    left_ = sum_;
    for (std::size_t i = 0; i < joints; ++i) apply_transposed(terms_.G[i], load_[static_cast<Index>(i)], left_.data());
  }
  change_ = sizes_;
  for (std::size_t i = 0; i < joints; ++i) measure(terms_.G[i], load_[static_cast<Index>(i)]);
  double left = 0, rounding = 0;
  for (Index b = 0; b < gyration_.size(); ++b) {
    const double rho = gyration_[b], torque = rotation(left_, b) / rho;
    const double size = sizes_[kBlock * b] + sizes_[kBlock * b + 1] + rotation(sizes_, b) / rho;
    const double known = kKnown * (1 + far(b) / rho) * size;
    left += left_[kBlock * b] * left_[kBlock * b] + left_[kBlock * b + 1] * left_[kBlock * b + 1] + torque * torque;
    rounding += known * known;
  }
  Verdict verdict{.immobile = left <= rounding};  // false of NaN
  if (!verdict.immobile || !system_.driven()) return verdict;
  left_.setZero();  // a velocity that the joints allow
  basic_.add_rates(terms_.joint_rate.data(), left_.data());
  const double rate = sum_.dot(left_);
  if (std::abs(rate) > rounding_of_rate(change_, left_) + rounding_of_drives()) verdict.rate = rate;
  return verdict;
}

/// [m/s] Of a body that the joints hold across J, J v is rounding of speeds along it, and of the fastest one elsewhere.
double Immobility::rounding_of_rate(const Eigen::VectorXd& sizes, const Eigen::VectorXd& v) const {
  constexpr double kDriven = 1e-9;  // of a body's speed
  const auto speed = [&](Index b) {
    return std::abs(v[kBlock * b]) + std::abs(v[kBlock * b + 1]) + gyration_[b] * std::abs(rotation(v, b));
  };
  double fastest = 0, rounding = 0;
  for (Index b = 0; b < gyration_.size(); ++b) fastest = std::max(fastest, speed(b));
  for (Index b = 0; b < gyration_.size(); ++b) {
    const double size = sizes[kBlock * b] + sizes[kBlock * b + 1] + rotation(sizes, b) / gyration_[b];
    rounding += size * (kDriven * speed(b) + kKnown * (1 + far(b) / gyration_[b]) * fastest);
  }
  return rounding;
}

/// [m/s] Of J v = −λᵀ ṡ.
double Immobility::rounding_of_drives() const {
  double rounding = 0;
  Index row = 0;
  for (const Joint& joint : system_.scene().joints) {
    if (const auto* drive = std::get_if<Drive>(&joint))
      rounding += kKnown * std::abs(load_[row]) * drive->law.size_of_rate(terms_.at.t);
    row += row_count(joint);
  }
  return rounding;
}

double Immobility::far(Index body) const {
  return terms_.unit + terms_.at.pose[static_cast<std::size_t>(body)].x.lpNorm<Eigen::Infinity>();
}

}  // namespace orthant
