#include <orthant/integrators/between_events/arc_interpolant.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr int kFits = 3;
constexpr double kPassed = 0.1;  // of the tolerance: inner velocities that move less are good enough
constexpr std::size_t kMostPieces = 32;
constexpr double kLeastTolerance = 1e-9;  // of impulses: rounding of forces, magnified by mass ratios

}  // namespace

ArcInterpolant::ArcInterpolant(const System& system)
    : motion_(system), of_(static_cast<std::size_t>(system.dof())), trial_q_(system.dof()), trial_v_(system.dof()) {
  forces_.reserve(motion_.modes.size());
  for (std::size_t k = 0; k < kPoints; ++k) {
    q_[k] = v_[k] = a_[k] = Eigen::VectorXd::Zero(system.dof());
    push_[k].resize(motion_.modes.size());
  }
}

void ArcInterpolant::remember(CheckpointData& memory) {
  memory(start_, length_, residual_, of_, forces_, pieces_, motion_);
}

ArcInterpolant::Quartic ArcInterpolant::through(const Quartic& f) {
  return {f[0], (-25 * f[0] + 48 * f[1] - 36 * f[2] + 16 * f[3] - 3 * f[4]) / 3,
          (70 * f[0] - 208 * f[1] + 228 * f[2] - 112 * f[3] + 22 * f[4]) / 3,
          (-80 * f[0] + 288 * f[1] - 384 * f[2] + 224 * f[3] - 48 * f[4]) / 3,
          (32 * f[0] - 128 * f[1] + 192 * f[2] - 128 * f[3] + 32 * f[4]) / 3};
}

void ArcInterpolant::fit(const Arc& arc, double tolerance) {
  motion_.modes = arc.modes;
  motion_.modes_changed();
  start_ = arc.start, length_ = arc.length;
  begin(arc);
  const double fast = std::max(arc.v0.lpNorm<Eigen::Infinity>(), arc.v1.lpNorm<Eigen::Infinity>());
  bool inside = true;
  for (int pass = 0; pass < kFits && inside; ++pass) {
    for (std::size_t k = 1; k + 1 < kPoints && inside; ++k) {
      const double x = static_cast<double>(k) / (kPoints - 1);
      inside = motion_.accelerations(start_ + x * length_, q_[k], v_[k], a_[k]);
      note_forces(k);
    }
    if (!inside)  // no accelerations there: a straight line between those at the ends
      for (std::size_t k = 1; k + 1 < kPoints; ++k)
        a_[k] = arc.a0 + static_cast<double>(k) / (kPoints - 1) * (arc.a1 - arc.a0);
    bend(arc);
    if (renew() <= kPassed * tolerance * fast) break;
  }
  fit_forces(arc, tolerance);
  residual_ = {};
}

/// Values at the five points, by the quintic Hermite polynomial and its derivative.
void ArcInterpolant::begin(const Arc& arc) {
  const double s = length_;
  q_[0] = arc.q0, v_[0] = arc.v0, a_[0] = arc.a0;
  q_[kPoints - 1] = arc.q1, v_[kPoints - 1] = arc.v1, a_[kPoints - 1] = arc.a1;
  for (std::size_t k = 1; k + 1 < kPoints; ++k) {
    const double x = static_cast<double>(k) / (kPoints - 1);
    for (Index i = 0; i < arc.q0.size(); ++i) {
      const double d = arc.q1[i] - arc.q0[i] - s * (arc.v0[i] + s / 2 * arc.a0[i]),
                   e = s * (arc.v1[i] - arc.v0[i] - s * arc.a0[i]), f = s * s * (arc.a1[i] - arc.a0[i]);
      const double c3 = 10 * d - 4 * e + f / 2, c4 = -15 * d + 7 * e - f, c5 = 6 * d - 3 * e + f / 2;
      q_[k][i] = arc.q0[i] + s * x * (arc.v0[i] + s * x / 2 * arc.a0[i]) + x * x * x * (c3 + x * (c4 + x * c5));
      v_[k][i] = arc.v0[i] + s * x * arc.a0[i] + x * x * (3 * c3 + x * (4 * c4 + x * 5 * c5)) / s;
    }
  }
}

void ArcInterpolant::note_forces(std::size_t k) {
  for (std::size_t i = 0; i < motion_.lasting().size(); ++i)
    push_[k][i] = {motion_.normal_force(i), motion_.tangent_force(i)};
}

/// The polynomials through the accelerations at the five points.
void ArcInterpolant::bend(const Arc& arc) {
  const double s = length_;
  for (std::size_t n = 0; n < of_.size(); ++n) {
    const auto i = static_cast<Index>(n);
    const Quartic a = through({a_[0][i], a_[1][i], a_[2][i], a_[3][i], a_[4][i]});
    Polynomials& p = of_[n];
    p.q = {arc.q0[i], s * arc.v0[i]}, p.v = {arc.v0[i]};
    double v_end = arc.v0[i], q_end = arc.q0[i] + s * arc.v0[i];
    for (std::size_t k = 0; k < kPoints; ++k) {
      const auto power = static_cast<double>(k);
      p.v[k + 1] = s * a[k] / (power + 1);
      p.q[k + 2] = s * p.v[k + 1] / (power + 2);
      v_end += p.v[k + 1], q_end += p.q[k + 2];
    }
    const double off_v = arc.v1[i] - v_end, off_q = arc.q1[i] - q_end;
    p.v[2] += 3 * off_v, p.v[3] -= 2 * off_v;
    p.q[2] += 3 * off_q, p.q[3] -= 2 * off_q;
  }
}

/// The inner points by the polynomials; how far that moved the velocities there.
double ArcInterpolant::renew() {
  double moved = 0;
  for (std::size_t k = 1; k + 1 < kPoints; ++k) {
    evaluate(static_cast<double>(k) / (kPoints - 1), q_[k], trial_v_);
    moved = std::max(moved, (trial_v_ - v_[k]).lpNorm<Eigen::Infinity>());
    v_[k].swap(trial_v_);
  }
  return moved;
}

void ArcInterpolant::fit_forces(const Arc& arc, double tolerance) {
  forces_.clear();
  pieces_ = 1;
  if (motion_.lasting().empty()) return;
  for (const std::size_t k : {std::size_t{0}, kPoints - 1}) {
    motion_.accelerations(start_ + (k == 0 ? 0 : length_), q_[k], v_[k], trial_v_);
    note_forces(k);
  }
  add_piece();
  while (pieces_ < kMostPieces && !forces_agree(arc, std::max(tolerance, kLeastTolerance)) && divide_forces())
    ;
}

/// From the forces at its five points.
void ArcInterpolant::add_piece() {
  for (std::size_t i = 0; i < motion_.lasting().size(); ++i) {
    Quartic normal, tangent;
    for (std::size_t k = 0; k < kPoints; ++k) normal[k] = push_[k][i].normal, tangent[k] = push_[k][i].tangent;
    forces_.push_back({motion_.lasting()[i], through(normal), through(tangent)});
  }
}

/// Twice as many pieces. False: there are no forces somewhere, and the pieces stay as they are.
bool ArcInterpolant::divide_forces() {
  const std::size_t before = forces_.size(), pieces = 2 * pieces_;
  for (std::size_t p = 0; p < pieces; ++p) {
    for (std::size_t k = 0; k < kPoints; ++k) {
      const double x = (static_cast<double>(p) + static_cast<double>(k) / (kPoints - 1)) / static_cast<double>(pieces);
      evaluate(x, trial_q_, trial_v_);
      if (!motion_.accelerations(start_ + x * length_, trial_q_, trial_v_, a_[1])) {
        forces_.resize(before);
        return false;
      }
      note_forces(k);
    }
    add_piece();
  }
  forces_.erase(forces_.begin(), forces_.begin() + static_cast<std::ptrdiff_t>(before));
  pieces_ = pieces;
  return true;
}

/// Whether the whole impulses are those of the step.
bool ArcInterpolant::forces_agree(const Arc& arc, double tolerance) const {
  for (const int contact : motion_.lasting()) {
    const Impulse whole = impulse(contact, start_ + length_), &known = arc.push[static_cast<std::size_t>(contact)];
    const double size = std::abs(known.normal) + std::abs(known.tangent);
    const double off = std::abs(whole.normal - known.normal) + std::abs(whole.tangent - known.tangent);
    if (off > tolerance * size) return false;
  }
  return true;
}

void ArcInterpolant::evaluate(double x, Eigen::VectorXd& q, Eigen::VectorXd& v) const {
  for (std::size_t i = 0; i < of_.size(); ++i) {
    const auto& [c, d] = of_[i];
    q[static_cast<Index>(i)] = c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * (c[5] + x * c[6])))));
    v[static_cast<Index>(i)] = d[0] + x * (d[1] + x * (d[2] + x * (d[3] + x * (d[4] + x * d[5]))));
  }
}

void ArcInterpolant::at(double t, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  evaluate(std::clamp((t - start_) / length_, 0.0, 1.0), q, v);
  if (motion_.system().joint_rows() == 0 && motion_.lasting().empty()) return;
  trial_q_ = q, trial_v_ = v;
  const ContactMotion::Residual left = motion_.project(t, trial_q_, trial_v_);
  if (left.joint < kInf) q = trial_q_, v = trial_v_, residual_ = left;
}

Impulse ArcInterpolant::impulse(int contact, double t) const {
  const auto pieces = static_cast<double>(pieces_);
  const double at = pieces * std::clamp((t - start_) / length_, 0.0, 1.0);
  const std::size_t lasting = forces_.size() / pieces_;
  Impulse sum;
  for (std::size_t p = 0; p < pieces_ && static_cast<double>(p) < at; ++p) {
    const double x = std::min(1.0, at - static_cast<double>(p));
    const auto integral = [&](const Quartic& f) {
      return length_ / pieces * x * (f[0] + x * (f[1] / 2 + x * (f[2] / 3 + x * (f[3] / 4 + x * f[4] / 5))));
    };
    for (std::size_t i = p * lasting; i < (p + 1) * lasting; ++i)
      if (forces_[i].contact == contact)
        sum.normal += integral(forces_[i].normal), sum.tangent += integral(forces_[i].tangent);
  }
  return sum;
}

}  // namespace orthant
