#include <orthant/integrators/derivatives/nearby_motion.h>
#include <orthant/integrators/step/rate_targets.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

constexpr double kInside = 0x1p-49;  // of the time
constexpr double kAlong = 1e-5;      // [s] at most, of a force's rate; coordinates move by as much at most

}  // namespace

NearbyMotion::NearbyMotion(const System& system)
    : system_(system), motion_(system), step_(system.dof()), at_(Terms(system).at) {
  for (auto* x : {&a_, &first_, &q_end_, &v_end_}) x->setZero(system.dof());
}

void NearbyMotion::set_modes(const std::vector<ContactMode>& modes) {
  motion_.modes = modes;
  motion_.modes_changed();
}

void NearbyMotion::project(double t, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  unused_ = v;
  motion_.project(t, q, unused_);  // its velocities may be along the rows before: how far off decides, with a jump
  motion_.project(t, q, v);
}

/// Forces are those of the times within: at its ends they may jump or bend.
bool NearbyMotion::move(double t, double length, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  const double least = std::min(length / 4, kInside * (std::abs(t) + length));
  const auto within = [&](double time) { return std::clamp(time, t + least, t + length - least); };
  project(t, q, v);
  if (!motion_.accelerations(within(t), q, v, first_)) return false;
  const auto acceleration = [&](double time, const Eigen::VectorXd& at_q, const Eigen::VectorXd& at_v,
                                Eigen::VectorXd& a) { return motion_.accelerations(within(time), at_q, at_v, a); };
  if (!step_.step(acceleration, t, q, v, first_, length, q_end_, v_end_, [](std::size_t) {})) return false;
  q = q_end_, v = v_end_;
  project(t + length, q, v);
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

double NearbyMotion::gap_acceleration(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                      const Eigen::VectorXd& a) {
  const double pulled = apply(rows(contact, t, q).normal, a.data());
  set_twists(system_, v, at_);
  return pulled + std::visit([&](const auto& c) { return c.bias(at_).normal; },
                             system_.scene().contacts[static_cast<std::size_t>(contact)]);
}

bool NearbyMotion::turns(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  constexpr double kStep = 1e-6, kTurns = 1e-6;  // [s] over the largest speed; of a row's entries
  const double s = kStep / std::max(1.0, v.lpNorm<Eigen::Infinity>());
  Eigen::VectorXd change = Eigen::VectorXd::Zero(q.size());
  apply_transposed(rows(contact, t, q).normal, -1, change.data());
  apply_transposed(rows(contact, t, q + s * v).normal, 1, change.data());
  return change.lpNorm<Eigen::Infinity>() > kTurns * s;
}

Eigen::VectorXd NearbyMotion::tangent_push(int contact, double t, const Eigen::VectorXd& q) {
  Eigen::VectorXd push = Eigen::VectorXd::Zero(system_.dof());
  apply_transposed(rows(contact, t, q).tangent, 1, push.data());
  return push;
}

double NearbyMotion::gap_scale(int contact, double t, const Eigen::VectorXd& q) {
  double sum = 0;
  each_entry(rows(contact, t, q).normal, [&](Eigen::Index place, double j) { sum += std::abs(j * q[place]); });
  return sum;
}

std::size_t NearbyMotion::place_among_lasting(int contact) const {
  const auto lasting = motion_.lasting();
  return static_cast<std::size_t>(std::ranges::find(lasting, contact) - lasting.begin());
}

double NearbyMotion::normal_force(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  motion_.accelerations(t, q, v, a_);
  return motion_.normal_force(place_among_lasting(contact));
}

double NearbyMotion::tangent_force(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  motion_.accelerations(t, q, v, a_);
  return motion_.tangent_force(place_among_lasting(contact));
}

double NearbyMotion::room(int contact, int side, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  const double tangent = tangent_force(contact, t, q, v);
  return static_mu(system_.law(contact)) * motion_.normal_force(place_among_lasting(contact)) - side * tangent;
}

double NearbyMotion::room_rate(int contact, int side, double t, double length, const Eigen::VectorXd& q,
                               const Eigen::VectorXd& v, const Eigen::VectorXd& a) {
  const double fast =
      std::max(v.lpNorm<Eigen::Infinity>(), a.lpNorm<Eigen::Infinity>() / (1 + v.lpNorm<Eigen::Infinity>()));
  const double s = kAlong / std::max(1.0, fast), least = kInside * std::abs(t);
  const auto at = [&](int k) {
    q_end_ = q + k * s * v + k * k * s * s / 2 * a, v_end_ = v + k * s * a;
    return room(contact, side, t + k * s - least, q_end_, v_end_);
  };
  if (4 * s < length) return (25 * at(0) - 48 * at(-1) + 36 * at(-2) - 16 * at(-3) + 3 * at(-4)) / (12 * s);
  return (at(-2) - 8 * at(-1) + 8 * at(1) - at(2)) / (12 * s);
}

void NearbyMotion::add_push(const Row& row) {
  push_.conservativeResize(system_.dof(), push_.cols() + 1);
  motion_.basic().solve_row(row, push_.rightCols(1).data());
}

Eigen::MatrixXd NearbyMotion::coupling(std::span<const Struck> contacts, double t, const Eigen::VectorXd& q) {
  v_end_.setZero(q.size());
  motion_.accelerations(t, q, v_end_, a_);  // factorizes
  push_.resize(q.size(), 0);
  for (const Struck& s : contacts) add_push(rows(s.contact, t, q).normal);
  Eigen::MatrixXd A(push_.cols(), push_.cols());
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index j = 0; j < A.cols(); ++j)
      A(i, j) = apply(rows(contacts[static_cast<std::size_t>(i)].contact, t, q).normal, push_.col(j).data());
  return A;
}

void NearbyMotion::touch(const std::vector<Struck>& struck, double t, Eigen::VectorXd& q) {
  constexpr int kPasses = 3;
  for (int pass = 0; pass < kPasses; ++pass) {
    v_end_.setZero(q.size());
    motion_.accelerations(t, q, v_end_, a_);  // factorizes
    push_.resize(q.size(), 0);
    const auto n = static_cast<Eigen::Index>(struck.size());
    Eigen::MatrixXd A(n, n);
    Eigen::VectorXd b(n);
    for (const Struck& s : struck) {
      const ContactRows of = rows(s.contact, t, q);
      add_push(s.slides != 0 ? combined(of.normal, s.slides * system_.law(s.contact).mu, of.tangent) : of.normal);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const int contact = struck[static_cast<std::size_t>(i)].contact;
      const Row normal = rows(contact, t, q).normal;
      b[i] = -gap(contact, t, q);
      for (Eigen::Index j = 0; j < n; ++j) A(i, j) = apply(normal, push_.col(j).data());
    }
    q += push_ * A.completeOrthogonalDecomposition().solve(b);
  }
}

double NearbyMotion::strike(const std::vector<Struck>& struck, double t, const Eigen::VectorXd& q, Eigen::VectorXd& v) {
  motion_.accelerations(t, q, v, a_);  // factorizes
  std::vector<Row> wanted;
  std::vector<double> target;
  push_.resize(v.size(), 0);
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
    for (Eigen::Index j = 0; j < n; ++j) A(i, j) = apply(row, push_.col(j).data());
  }
  const Eigen::VectorXd impulses = A.completeOrthogonalDecomposition().solve(b);  // tangents of one body may depend
  v += push_ * impulses;
  return (A * impulses - b).lpNorm<Eigen::Infinity>();
}

}  // namespace orthant
