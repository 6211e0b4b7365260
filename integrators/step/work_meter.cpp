#include <orthant/integrators/step/work_meter.h>

#include <cmath>

namespace orthant {

WorkMeter::WorkMeter(const System& system)
    : StepWorkOf<Planar>(system),
      system_(system),
      point_(system),
      from_(system),
      to_point_(system),
      acceleration_(system.dof()) {}

double WorkMeter::power(double t, const MotionPoint& p) {
  return motion_->accelerations(t, p.q, p.v, acceleration_) ? motion_->power(t, p.v, acceleration_) : 0;
}

double WorkMeter::over_motion(double t, double s, const MotionPoint& a, const MotionPoint& b,
                              const std::vector<ContactMode>& modes) {
  const double aside = std::sqrt(0.15);  // Gauss–Legendre, degree 5
  if (!motion_) motion_ = std::make_unique<ContactMotion>(system_);
  motion_->modes = modes, motion_->modes_changed();
  double sum = 0;
  for (const auto& [x, weight] : {std::pair{0.5 - aside, 5.0 / 18}, {0.5, 4.0 / 9}, {0.5 + aside, 5.0 / 18}}) {
    interpolate(a, b, s, x, point_);
    sum += s * weight * power(t + x * s, point_);
  }
  return sum;
}

double WorkMeter::over_motion(const State& from, const State& to, const std::vector<ContactMode>& modes) {
  if (!motion_) motion_ = std::make_unique<ContactMotion>(system_);
  motion_->modes = modes, motion_->modes_changed();
  from_.q = from.q, from_.v = from.v, to_point_.q = to.q, to_point_.v = to.v;
  if (!motion_->accelerations(from.t, from.q, from.v, from_.a)) return 0;
  if (!motion_->accelerations(to.t, to.q, to.v, to_point_.a)) return 0;
  return over_motion(from.t, to.t - from.t, from_, to_point_, modes);
}

void WorkMeter::forget() { motion_.reset(); }

double WorkMeter::over_impact(const Terms& terms, const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                              const std::vector<Impulse>& impulses) const {
  double sum = 0;
  const auto mean = [&](const Row& row) { return (apply(row, before.data()) + apply(row, after.data())) / 2; };
  if (system_.driven()) sum = (before + after).dot(system_.mass().cwiseProduct(after - before)) / 2;
  for (const ClosedContact& c : terms.closed) {
    const Impulse& impulse = impulses[static_cast<std::size_t>(c.contact)];
    sum += impulse.tangent * system_.law(c.contact).belt;
    if (system_.driven()) sum -= impulse.normal * mean(c.rows.normal) + impulse.tangent * mean(c.rows.tangent);
  }
  return sum;
}

}  // namespace orthant
