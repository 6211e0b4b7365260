#include <orthant/solvers/first_order/mprgp.h>

#include <algorithm>
#include <cmath>

namespace orthant {

void Mprgp::free_gradient(const Vector& z) {
  phi_.resize(z.size());
  for (Index i = 0; i < z.size(); ++i) phi_[i] = bounds_.lo[i] < z[i] && z[i] < bounds_.hi[i] ? w_[i] : 0;
}

void Mprgp::begin_at(const Lcp& problem, const Vector& z) {
  multiply(problem.A, z, w_, scratch_);
  w_ += problem.b;
  free_gradient(z);
  p_ = phi_.cwiseQuotient(bounds_.d);
  age_ = 0;
}

void Mprgp::curvature(const Lcp& problem, const Vector& p) {
  multiply(problem.A, p, Ap_, scratch_);
  pAp_ = p.dot(Ap_);
  if (const double length = detail::dot(bounds_.d, p, p); length > 0) largest_ = std::max(largest_, pAp_ / length);
}

void Mprgp::load(const Lcp& problem, Vector& z) {
  bounds_.load(problem, z);
  largest_ = detail::largest_ratio(problem.A, bounds_.d, problem.b, q_, Ap_, scratch_);
  begin_at(problem, z);
}

double Mprgp::room(const Vector& z, const Vector& p) const {
  double t = kInf;
  for (Index i = 0; i < z.size(); ++i)
    if (p[i] != 0) t = std::min(t, (z[i] - (p[i] > 0 ? bounds_.lo : bounds_.hi)[i]) / p[i]);
  return t;
}

void Mprgp::move(Vector& z, double t, const Vector& p) const {
  for (Index i = 0; i < z.size(); ++i) {
    if (p[i] == 0) continue;
    const double bound = (p[i] > 0 ? bounds_.lo : bounds_.hi)[i];
    z[i] = (z[i] - bound) / p[i] <= t ? bound : std::clamp(z[i] - t * p[i], bounds_.lo[i], bounds_.hi[i]);
  }
}

Mprgp::Step Mprgp::advance(const Lcp& problem, Vector& z) {
  const Vector &d = bounds_.d, &lo = bounds_.lo, &hi = bounds_.hi;
  const double alpha = largest_ > 0 ? options_.step / largest_ : 1;
  double chopped = 0, reduced = 0;  // ‖β‖², φ̃ᵀφ
  q_.resize(z.size());
  for (Index i = 0; i < z.size(); ++i) {
    q_[i] = 0;
    if (phi_[i] != 0) {
      const double room = (phi_[i] > 0 ? z[i] - lo[i] : hi[i] - z[i]) * d[i] / alpha;
      reduced += std::min(room, std::abs(phi_[i])) * std::abs(phi_[i]) / d[i];
    } else if ((z[i] == lo[i] && z[i] < hi[i] && w_[i] < 0) || (z[i] == hi[i] && z[i] > lo[i] && w_[i] > 0)) {
      q_[i] = w_[i] / d[i];
      chopped += w_[i] * q_[i];
    }
  }
  const bool proportional = chopped <= options_.gamma * options_.gamma * reduced;
  Vector& p = proportional ? p_ : q_;
  before_ = z;
  curvature(problem, p);
  const double slope = w_.dot(p), size = detail::dot(d, p, p), limit = room(z, p);
  // Curvature that is rounding is none.
  const bool flat = std::abs(pAp_) <= 1e-14 * static_cast<double>(z.size()) * largest_ * size;
  Step step{.event = proportional ? "" : "proportioning"};
  if (slope > 0) {
    const double best = flat ? kInf : slope / pAp_;
    if (best < 0 || std::min(best, limit) == kInf) {
      step.violation = bounds_.violation(problem, z, w_);
      step.event = best < 0 ? "negative curvature" : "ray";
      step.end = best < 0 || !problem.friction.empty() ? Claim::stalled : Claim::ray;  // held bounds prove nothing
      p *= -1;
      step.ray = &p;
      return step;
    }
    step.length = std::min(best, limit);
    move(z, step.length, p);
    w_ -= step.length * Ap_;
    if (best <= limit) {
      free_gradient(z);
      const double conjugate = proportional ? (phi_.array() / d.array() * Ap_.array()).sum() / pAp_ : 0;
      p_ = phi_.cwiseQuotient(d) - conjugate * p_;
    } else {
      if (proportional) {  // the face is left: expansion
        step.event = "expansion";
        free_gradient(z);
        z = (z - alpha * phi_.cwiseQuotient(d)).cwiseMax(lo).cwiseMin(hi);
      }
      begin_at(problem, z);
    }
  } else {
    begin_at(problem, z);  // no descent: the direction is rounding
  }
  step.moved = z != before_ || age_ > 0;
  if (++age_ >= 50 || z == before_) {
    multiply(problem.A, z, w_, scratch_);
    w_ += problem.b;
    age_ = 0;
  }
  step.violation = bounds_.violation(problem, z, w_);
  if (bounds_.outdated()) {
    bounds_.hold(problem, z);
    begin_at(problem, z);
    step.event = "friction bounds";
  }
  return step;
}

}  // namespace orthant
