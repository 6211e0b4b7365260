#include <orthant/integrators/derivatives/nearby_motion.h>
#include <orthant/integrators/step/rate_targets.h>

#include <Eigen/QR>

namespace orthant {

NearbyMotion::NearbyMotion(const System& system)
    : system_(system), motion_(system), step_(system.dof()), at_(Terms(system).at) {
  for (auto* x : {&a_, &first_, &q_end_, &v_end_}) x->setZero(system.dof());
}

void NearbyMotion::set_modes(const std::vector<ContactMode>& modes) {
  motion_.modes = modes;
  motion_.modes_changed();
}

bool NearbyMotion::move(double t, double length, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  motion_.project(t, q, v);
  if (!motion_.accelerations(t, q, v, first_)) return false;
  const auto acceleration = [&](double time, const Eigen::VectorXd& at_q, const Eigen::VectorXd& at_v,
                                Eigen::VectorXd& a) { return motion_.accelerations(time, at_q, at_v, a); };
  if (!step_.step(acceleration, t, q, v, first_, length, q_end_, v_end_, [](std::size_t) {})) return false;
  q = q_end_, v = v_end_;
  motion_.project(t + length, q, v);
  return true;
}

ContactRows NearbyMotion::rows(int contact, double t, const Eigen::VectorXd& q) {
  set_poses(system_, t, q, at_);
  return std::visit([&](const auto& c) { return c.rows(at_); },
                    system_.scene().contacts[static_cast<std::size_t>(contact)]);
}

double NearbyMotion::gap(int contact, double t, const Eigen::VectorXd& q) {
  set_poses(system_, t, q, at_);
  return gap_of(system_, {}, contact, at_);
}

double NearbyMotion::slip(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  return apply(rows(contact, t, q).tangent, v.data()) - system_.law(contact).belt;
}

double NearbyMotion::gap_rate(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  return apply(rows(contact, t, q).normal, v.data());
}

double NearbyMotion::slip_rate(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                               const Eigen::VectorXd& a) {
  const double pulled = apply(rows(contact, t, q).tangent, a.data());
  set_twists(system_, v, at_);
  return pulled + std::visit([&](const auto& c) { return c.bias(at_).tangent; },
                             system_.scene().contacts[static_cast<std::size_t>(contact)]);
}

void NearbyMotion::strike(const std::vector<Struck>& struck, double t, const Eigen::VectorXd& q, Eigen::VectorXd& v) {
  motion_.accelerations(t, q, v, a_);  // factorizes
  std::vector<Row> wanted;
  std::vector<double> target;
  Eigen::MatrixXd push(v.size(), 0);
  const auto add_push = [&](const Row& row) {
    push.conservativeResize(Eigen::NoChange, push.cols() + 1);
    motion_.basic().solve_row(row, push.rightCols(1).data());
  };
  for (const Struck& s : struck) {
    const ContactRows of = rows(s.contact, t, q);
    const ContactLaw& law = system_.law(s.contact);
    const double approach = apply(of.normal, v.data());
    wanted.push_back(of.normal);
    target.push_back(s.plastic ? 0 : -law.e * approach);
    add_push(s.slides != 0 ? combined(of.normal, s.slides * law.mu, of.tangent) : of.normal);
    if (!s.sticks) continue;
    const bool strikes = -approach > kRestSpeed * law.unit;
    wanted.push_back(of.tangent);
    target.push_back(law.belt - (strikes ? law.e_t * (apply(of.tangent, v.data()) - law.belt) : 0));
    add_push(of.tangent);
  }
  const auto n = static_cast<Eigen::Index>(wanted.size());
  Eigen::MatrixXd A(n, n);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = wanted[static_cast<std::size_t>(i)];
    b[i] = target[static_cast<std::size_t>(i)] - apply(row, v.data());
    for (Eigen::Index j = 0; j < n; ++j) A(i, j) = apply(row, push.col(j).data());
  }
  v += push * A.completeOrthogonalDecomposition().solve(b);  // tangents of one body may depend on each other
}

}  // namespace orthant
