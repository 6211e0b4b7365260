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

/// |Φ_i|, each over its row's unit.
template <class Space> double largest_in_units(const TermsOf<Space>& terms) {
  if (terms.unit == 1) return largest(terms.phi);
  return largest_off(terms.phi.size(), [&](Index i) { return std::abs(terms.phi[i]) / terms.unit_of_row(i); });
}

/// The largest entry of the velocities v, or of the coordinates q, of row i's bodies; lengths over `unit`.
struct OfVelocities {
  template <class Space> static double entry(const Eigen::VectorXd& v, BodyId body, double unit) {
    if constexpr (kPlanar<Space>)
      return largest_coordinate(v, body, unit);
    else
      return largest_entry<Space>(v, body);
  }
};
struct OfCoordinates {
  template <class Space> static double entry(const Eigen::VectorXd& q, BodyId body, double unit) {
    return largest_coordinate<Space>(q, body, unit);
  }
};
/// [its row's unit] What |off_i| is measured against.
template <class Of, class Space> double known(const TermsOf<Space>& terms, const Eigen::VectorXd& x, Index i) {
  const auto& row = terms.G[static_cast<std::size_t>(i)];
  double most = 0;
  for (const BodyId body : {row.a, row.b})
    if (body >= 0) most = std::max(most, Of::template entry<Space>(x, body, terms.unit));
  return terms.unit == 1 ? 1 + most : terms.unit_of_row(i) * (1 + most / terms.unit);
}

/// Some |off_i| is more than rounding of x, or NaN. worst: the largest of them.
template <class Of, class Space>
bool misses(double worst, const TermsOf<Space>& terms, const Eigen::VectorXd& x, const Eigen::VectorXd& off) {
  constexpr double kTolerance = 1e-15;
  if (worst <= kTolerance * terms.unit) return false;
  for (Index i = 0; i < off.size(); ++i)
    if (!(std::abs(off[i]) <= kTolerance * known<Of>(terms, x, i))) return true;
  return false;
}

}  // namespace

template <class Space>
double off_by(const TermsOf<Space>& terms, const Eigen::VectorXd& v, const Eigen::VectorXd& off) {
  return largest_off(off.size(), [&](Index i) { return std::abs(off[i]) / known<OfVelocities>(terms, v, i); });
}

template <class Space>
double off_at(const TermsOf<Space>& terms, const Eigen::VectorXd& q, const Eigen::VectorXd& off) {
  return largest_off(off.size(), [&](Index i) { return std::abs(off[i]) / known<OfCoordinates>(terms, q, i); });
}

template <class Space> double joints_off(const TermsOf<Space>& terms, const Eigen::VectorXd& q, Magnitudes& far) {
  constexpr double kClosed = 1e-9;
  constexpr double kAngle = 1e-6;  // [m/rad] turning rounds to 1e-16 of an angle, far less than is asked of places
  const Index rows = terms.phi.size();
  const double worst = largest_in_units(terms), unit = terms.unit;
  if (worst <= kClosed) return worst;
  far.measure([&](Index i) {
    if constexpr (kPlanar<Space>)
      return std::max(largest_translation(q, i) / unit, kAngle * std::abs(rotation(q, i)));
    else
      return largest_coordinate<Space>(q, i);
  });
  return largest_off(rows, [&](Index i) {
    return std::abs(terms.phi[i]) / (terms.unit_of_row(i) * (1 + far.of(terms.G[static_cast<std::size_t>(i)])));
  });
}

template <class Space> ProjectionOf<Space>::ProjectionOf(const System& system, bool with_joints)
    : system_(system),
      basic_(system, with_joints),
      far_(system.assembly()),
      trial_(system.coordinates()),
      rate_(system.joint_rows()) {}

template <class Space>
double ProjectionOf<Space>::position(double t, Terms& terms, Eigen::VectorXd& q, const Eigen::VectorXd* added) {
  constexpr int kMatrices = 8;
  set_poses(system_, t, q, terms.at);
  evaluate_joints(system_, terms);
  if (terms.phi.size() == 0) return 0;
  if (basic_.joint_rows() == 0) return largest(terms.phi);
  double worst = largest(terms.phi);
  for (int matrices = 0;
       matrices == 0 || (matrices < kMatrices && !((terms.unit == 1 ? worst : largest_in_units(terms)) <= kJointsHold));
       ++matrices) {
    if (!basic_.factorize(system_, terms, 0, 0, added)) return std::numeric_limits<double>::infinity();
    worst = approach(t, terms, q, worst);
  }
  return worst;
}

template <class Space> double ProjectionOf<Space>::approach(double t, Terms& terms, Eigen::VectorXd& q, double worst) {
  constexpr int kIterations = 20;
  bool more = misses<OfCoordinates>(worst, terms, q, terms.phi);
  for (int i = 0; i < kIterations && more; ++i) {
    rate_ = -terms.phi;
    if constexpr (kPlanar<Space>) {
      trial_ = q;
      basic_.add_rates(rate_.data(), trial_.data());
    } else {
      step_.setZero(system_.dof());
      basic_.add_rates(rate_.data(), step_.data());
      move<Space>(q, step_, trial_);
    }
    set_poses(system_, t, trial_, terms.at);
    evaluate_joints(system_, terms);
    const double next = largest(terms.phi);
    more = misses<OfCoordinates>(next, terms, trial_, terms.phi);
    if (more && !(off_at(terms, q, terms.phi) < off_at(terms, q, rate_))) {  // rounding, or it diverges: q is better
      set_poses(system_, t, q, terms.at);
      evaluate_joints(system_, terms);
      break;
    }
    q.swap(trial_);
    worst = next;
  }
  return worst;
}

template <class Space> double ProjectionOf<Space>::velocity(Terms& terms, Eigen::VectorXd& v) {
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
  if (left <= kOnce * terms.unit && !system_.driven()) return left;
  for (int i = 1; i < kIterations && misses<OfVelocities>(left, terms, v, rate_); ++i) {
    const double next = correct();
    if (!(next < left)) return next;  // rounding level reached
    left = next;
  }
  return left;
}

template class ProjectionOf<Planar>;
template class ProjectionOf<Spatial>;
template double joints_off(const TermsOf<Planar>&, const Eigen::VectorXd&, Magnitudes&);
template double joints_off(const TermsOf<Spatial>&, const Eigen::VectorXd&, Magnitudes&);
template double off_by(const TermsOf<Planar>&, const Eigen::VectorXd&, const Eigen::VectorXd&);
template double off_by(const TermsOf<Spatial>&, const Eigen::VectorXd&, const Eigen::VectorXd&);
template double off_at(const TermsOf<Planar>&, const Eigen::VectorXd&, const Eigen::VectorXd&);
template double off_at(const TermsOf<Spatial>&, const Eigen::VectorXd&, const Eigen::VectorXd&);

}  // namespace orthant
