#include <orthant/integrators/step/work_meter.h>

#include <algorithm>
#include <cmath>

namespace orthant {

bool WorkMeter::needed(const System& system) {
  return system.driven() || !system.scene().loads.empty() ||
         std::ranges::any_of(system.laws(), [](const ContactLaw& law) { return law.belt != 0; });
}

WorkMeter::WorkMeter(const System& system)
    : system_(system),
      terms_(system),
      basic_(system),
      point_(system),
      from_(system),
      to_point_(system),
      to_(terms_.at),
      middle_(system.dof()),
      force_(system.dof()),
      mean_(system.dof()),
      lambda_(system.joint_rows()),
      rate_(system.joint_rows()),
      none_(Eigen::VectorXd::Zero(system.joint_rows())) {}

/// terms_.at are the poses at `from`.
double WorkMeter::of_loads(const State& from, const State& to) {
  if (system_.scene().loads.empty()) return 0;
  set_poses(system_, to.t, to.q, to_);
  double sum = 0;
  for (const Load& load : system_.scene().loads) {
    const auto place = [&](const Kinematics& k) -> Vector2d {
      return k.at(load.body).x + k.at(load.body).turn(load.point);
    };
    const auto factor = [&](double t) { return load.factor ? load.factor(t) : 1.0; };
    const double scale = load.factor ? (factor(from.t) + 4 * factor((from.t + to.t) / 2) + factor(to.t)) / 6 : 1;
    sum += scale * (load.force.dot(place(to_) - place(terms_.at)) +
                    load.torque * (to_.at(load.body).theta - terms_.at.at(load.body).theta));
  }
  return sum;
}

double WorkMeter::over_step(const State& from, const State& to, const std::vector<Impulse>& impulses,
                            const std::vector<double>& frictions, std::span<const Pair> pairs) {
  const double h = to.t - from.t, t = from.t + h / 2;
  set_poses(system_, from.t, from.q, terms_.at);
  double sum = of_loads(from, to);
  for (std::size_t i = 0; i < impulses.size(); ++i)
    if (impulses[i].tangent != 0) sum += impulses[i].tangent * system_.laws()[i].belt;
  if (!system_.driven()) return sum;

  evaluate_joint_rows(system_, terms_);  // rates at both ends: their mean is right where a drive's rate jumps, too
  rate_ = terms_.joint_rate;
  set_poses(system_, to.t, to.q, terms_.at);
  evaluate_joint_rows(system_, terms_);
  rate_ = (rate_ + terms_.joint_rate) / 2;
  middle_ = (from.q + to.q) / 2, mean_ = (from.v + to.v) / 2;
  if (!pairs.empty()) terms_.pairs.assign(pairs.begin(), pairs.end());
  set_poses(system_, t, middle_, terms_.at);
  evaluate_forces(system_, t, mean_, terms_);
  evaluate_joint_rows(system_, terms_);
  force_ = h * terms_.f - system_.mass().cwiseProduct(to.v - from.v);
  terms_.closed.clear();
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    if (impulses[i].normal == 0 && impulses[i].tangent == 0) continue;
    add_closed(system_, static_cast<int>(i), terms_);
    apply_transposed(terms_.closed.back().rows.normal, impulses[i].normal, force_.data());
    apply_transposed(terms_.closed.back().rows.tangent, impulses[i].tangent, force_.data());
  }
  for (std::size_t i = 0; i < frictions.size(); ++i)
    apply_transposed(system_.scene().frictions[i].of.row(terms_.at), frictions[i], force_.data());
  if (!basic_.factorize(system_, terms_)) return sum;
  basic_.solve(force_.data(), none_.data(), middle_.data(), lambda_.data());
  return sum + lambda_.dot(rate_);
}

double WorkMeter::power(double t, const MotionPoint& p) {
  if (!motion_->accelerations(t, p.q, p.v, force_)) return 0;
  const Terms& terms = motion_->terms();
  double sum = 0;
  if (system_.driven()) sum = p.v.dot(system_.mass().cwiseProduct(force_) - terms.f);
  for (std::size_t i = 0; i < motion_->lasting().size(); ++i) {
    const ContactRows& rows = terms.closed[i].rows;
    const double tangent = motion_->tangent_force(i), belt = system_.law(motion_->lasting()[i]).belt;
    sum += tangent * belt;
    if (system_.driven())
      sum -= motion_->normal_force(i) * apply(rows.normal, p.v.data()) + tangent * apply(rows.tangent, p.v.data());
  }
  force_.setZero();
  for (const Load& load : system_.scene().loads) load.add(terms.at, t, force_.data());
  return sum + force_.dot(p.v);
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

void WorkMeter::forget() {
  basic_.forget();
  motion_.reset();
}

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
