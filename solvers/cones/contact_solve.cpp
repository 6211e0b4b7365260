#include <orthant/solvers/cones/contact_map.h>
#include <orthant/solvers/cones/contact_solve.h>

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace orthant {
namespace {

using cones::Block, cones::Blocks;
constexpr double kContactRounding = 4 * std::numeric_limits<double>::epsilon();
using ContactMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, cones::kMostRows, cones::kMostRows>;
using ContactVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, cones::kMostRows, 1>;
using ContactMatrixMap = Eigen::Map<const Eigen::MatrixXd>;

/// One contact's data and the best z so far.
struct ContactSearch {
  const Blocks& blocks;
  const Block& block;
  ContactMatrixMap A;
  ContactVector q, best = {};
  double residual = kInf;
  double enough = 0;  // the residual that rounding leaves

  /// ‖z − P_K(z − û)‖; z is kept where it is the best.
  double judge(const ContactVector& z) {
    const ContactVector w = A * z + q;
    const double e = blocks.residual(block, z.data(), w.data());
    if (e < residual) residual = e, best = z;
    return e;
  }
  bool done() const { return residual <= enough; }
};

void contact_newton(ContactSearch& s, double rho_n, double rho_t) {
  const int m = s.block.rows;
  ContactVector z = s.best;
  ContactMatrix E(m, m), H(m, m);
  ContactVector F(m);
  double last = s.residual;
  for (int step = 0; step < 12 && !s.done(); ++step) {
    const ContactVector w = s.A * z + s.q;
    evaluate_map(ContactMap::alart_curnier, s.blocks, s.block, z.data(), w.data(), rho_n, rho_t, F.data(), E.data(),
                 H.data());
    const ContactMatrix J = E + H * s.A;
    const ContactVector dz = J.partialPivLu().solve(F);
    if (!dz.allFinite()) return;
    z -= dz;
    const double e = s.judge(z);
    if (step >= 4 && e > 0.5 * last) return;  // few steps are all it needs where it works
    last = e;
  }
}

/// Roots on the circle of (1); calls use(cos θ, sin θ).
template <class Use> void each_direction(double P, double Q, double U, double V, double X, const Use& use) {
  const auto h = [&](double c, double s) { return P * c + Q * s + U * c * c + V * s * s + X * s * c; };
  // Turn the plane so that tan(θ/2) is not infinite at a root: h(π) becomes the largest of eight.
  double turn = 0, largest = -1;
  for (int k = 0; k < 8; ++k) {
    const double angle = k * M_PI / 4, value = std::abs(h(std::cos(angle), std::sin(angle)));
    if (value > largest) largest = value, turn = angle - M_PI;
  }
  if (!(largest > 0)) return use(1.0, 0.0);  // every direction is one
  const double ct = std::cos(turn), st = std::sin(turn);
  // θ = φ + turn: cos θ = ct c − st s, sin θ = st c + ct s
  const double p = P * ct + Q * st, q = Q * ct - P * st;
  const double u = U * ct * ct + V * st * st + X * st * ct, v = U * st * st + V * ct * ct - X * st * ct;
  const double x = 2 * (V - U) * st * ct + X * (ct * ct - st * st);
  const double c4 = u - p, c3 = 2 * (q - x), c2 = 4 * v - 2 * u, c1 = 2 * (q + x), c0 = u + p;
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  companion(0, 3) = -c0 / c4, companion(1, 3) = -c1 / c4, companion(2, 3) = -c2 / c4, companion(3, 3) = -c3 / c4;
  companion(1, 0) = companion(2, 1) = companion(3, 2) = 1;
  if (!companion.allFinite()) return;
  const Eigen::EigenSolver<Eigen::Matrix4d> roots(companion, false);
  for (const auto& root : roots.eigenvalues()) {
    if (std::abs(root.imag()) > 1e-5 * (1 + std::abs(root.real()))) continue;  // double roots leave the real line
    double angle = 2 * std::atan(root.real()) + turn;
    for (int k = 0; k < 3; ++k) {  // polished on the circle
      const double c = std::cos(angle), s = std::sin(angle);
      const double slope = -P * s + Q * c + 2 * (V - U) * s * c + X * (c * c - s * s);
      const double change = slope != 0 ? h(c, s) / slope : 0;
      if (std::abs(change) > 0.1) break;
      angle -= change;
    }
    use(std::cos(angle), std::sin(angle));
  }
}

void contact_cases(ContactSearch& s, double mu) {
  const auto& A = s.A;
  const ContactVector& q = s.q;
  ContactVector z = ContactVector::Zero(3);
  s.judge(z);
  if (s.done()) return;
  z = A.partialPivLu().solve(-q);
  if (z.allFinite()) s.judge(z);
  if (s.done()) return;
  const double N = A(0, 0), a1 = A(0, 1), a2 = A(0, 2), c1 = A(1, 0), c2 = A(2, 0);
  each_direction(N * q[2] - q[0] * c2, q[0] * c1 - N * q[1], mu * (q[2] * a1 - q[0] * A(2, 1)),
                 mu * (q[0] * A(1, 2) - q[1] * a2), mu * (q[2] * a2 - q[1] * a1 - q[0] * (A(2, 2) - A(1, 1))),
                 [&](double c, double sine) {
                   const double normal = -q[0] / (N + mu * (a1 * c + a2 * sine));
                   if (!(normal >= 0 && normal < kInf)) return;
                   z[0] = normal, z[1] = mu * normal * c, z[2] = mu * normal * sine;
                   s.judge(z);
                 });
}

void contact_fixed_point(ContactSearch& s, double rho) {
  ContactVector z = s.best, x(s.block.rows);
  double last = s.residual;
  for (int step = 0; step < 200 && !s.done(); ++step) {
    const ContactVector w = s.A * z + s.q;
    s.blocks.correct(s.block, w.data(), x.data());
    x = z - rho * x;
    ContactVector next(s.block.rows);
    s.blocks.project(s.block, x.data(), next.data());
    const double e = s.judge(next);
    if (!(e < last)) rho *= 0.7;
    z = next, last = e;
  }
}

}  // namespace

namespace {

bool of_one_disc(const Block& b, const double* A) {
  return b.rows == 3 && b.parts == 1 && b.lo == 0 && b.hi == kInf && A[0] > 0;
}

}  // namespace

bool DiscContact::solve_once(const Blocks& blocks, const Block& b, const double* A, const double* q, double* z) {
  if (!of_one_disc(b, A)) return false;
  if (!(q[0] < 0)) {
    z[0] = z[1] = z[2] = 0;
    return true;
  }
  DiscContact contact;
  contact.prepare(blocks, b, A);
  return contact.load(q, z);
}

void DiscContact::prepare(const Blocks& blocks, const Block& b, const double* A) {
  disc_ = of_one_disc(b, A);
  if (!disc_) return;
  A_ = A, mu_ = blocks.parts(b)[0].mu;
  const Eigen::Map<const Eigen::Matrix3d> M(A);
  const Eigen::Vector3d first = M.col(1).cross(M.col(2));
  const double determinant = M.col(0).dot(first);
  regular_ = determinant > 1e-10 * (M(0, 0) * M(1, 1) * M(2, 2));
  if (!regular_) return;
  Eigen::Map<Eigen::Matrix3d> columns(inverse_.data());
  columns << first, M.col(2).cross(M.col(0)), M.col(0).cross(M.col(1));
  columns /= determinant;
}

/// A contact that is not open: stick, else the direction of sliding.
bool DiscContact::load(const double* q, double* z) const {
  if (regular_) {
    const double* const R = inverse_.data();
    const double n = -(R[0] * q[0] + R[1] * q[1] + R[2] * q[2]), t1 = -(R[3] * q[0] + R[4] * q[1] + R[5] * q[2]),
                 t2 = -(R[6] * q[0] + R[7] * q[1] + R[8] * q[2]);
    if (n >= 0 && t1 * t1 + t2 * t2 <= mu_ * mu_ * n * n) {
      z[0] = n, z[1] = t1, z[2] = t2;
      return true;
    }
  }
  double c = z[1], s = z[2], square = c * c + s * s;
  if (!(square > 0)) c = -q[1], s = -q[2], square = c * c + s * s;
  if (!(square > 0)) c = 1, s = 0, square = 1;
  const double length = std::sqrt(square);
  c /= length, s /= length;
  if (slide(q, c, s, z)) return true;
  for (int k = 0; k < 8; ++k) {
    const double angle = std::atan2(-q[2], -q[1]) + k * M_PI / 4;
    if (slide(q, std::cos(angle), std::sin(angle), z)) return true;
  }
  return false;
}

/// Newton on (1) from the direction (c, s), along the circle's tangent.
bool DiscContact::slide(const double* q, double c, double s, double* z) const {
  const double* const A = A_;
  const double mu = mu_, q_size = std::abs(q[1]) + std::abs(q[2]);
  double before_c = 0, before_s = 0;
  for (int step = 0; step < 20; ++step) {
    const double total = A[0] + mu * (A[3] * c + A[6] * s);
    if (!(total > 1e-10 * A[0])) {  // no normal impulse slides there: half the way back
      c += before_c, s += before_s;
      const double shorter = 1 / std::sqrt(c * c + s * s);
      if (step == 0 || !(shorter < 1e10)) return false;
      c *= shorter, s *= shorter;
      continue;
    }
    before_c = c, before_s = s;
    const double normal = -q[0] / total;
    const double a1 = A[4] * c + A[7] * s, a2 = A[5] * c + A[8] * s;
    const double t1 = A[1] + mu * a1, t2 = A[2] + mu * a2;
    const double w1 = q[1] + normal * t1, w2 = q[2] + normal * t2;
    const double f = c * w2 - s * w1, along = c * w1 + s * w2;
    if (std::abs(f) <= kContactRounding * (q_size + normal * (std::abs(t1) + std::abs(t2)))) {
      if (!(along <= 0)) return false;
      z[0] = normal, z[1] = mu * normal * c, z[2] = mu * normal * s;
      return true;
    }
    const double change = -normal * mu * (A[6] * c - A[3] * s) / total;
    const double e1 = A[7] * c - A[4] * s, e2 = A[8] * c - A[5] * s;
    const double slope = -along + c * (change * t2 + normal * mu * e2) - s * (change * t1 + normal * mu * e1);
    const double turn = std::clamp(-f / slope, -1.0, 1.0);
    if (!std::isfinite(turn)) return false;
    const double next_c = c - turn * s, next_s = s + turn * c, longer = 1 / std::sqrt(1 + turn * turn);
    c = next_c * longer, s = next_s * longer;
  }
  return false;
}

double solve_contact(const Blocks& blocks, const Block& b, const double* A, const double* q, double* z) {
  const int m = b.rows;
  if (m == 1) {  // a row by itself
    const double w = A[0] * z[0] + q[0];
    z[0] = A[0] > 0 ? std::clamp(-q[0] / A[0], b.lo, b.hi) : std::clamp(z[0] - w, b.lo, b.hi);
    const double now = A[0] * z[0] + q[0];
    return blocks.residual(b, z, &now);
  }
  if (DiscContact::solve_once(blocks, b, A, q, z)) {
    const std::array<double, 3> w{A[0] * z[0] + A[3] * z[1] + A[6] * z[2] + q[0],
                                  A[1] * z[0] + A[4] * z[1] + A[7] * z[2] + q[1],
                                  A[2] * z[0] + A[5] * z[1] + A[8] * z[2] + q[2]};
    return blocks.residual(b, z, w.data());
  }
  ContactSearch s{
      .blocks = blocks, .block = b, .A = ContactMatrixMap(A, m, m), .q = Eigen::Map<const Eigen::VectorXd>(q, m)};
  s.enough = kContactRounding * s.q.norm();
  s.best = Eigen::Map<const Eigen::VectorXd>(z, m);
  s.judge(s.best);
  double trace = 0;
  for (int r = 1; r < m; ++r) trace += A[r + m * r];
  const double rho_n = A[0] > 0 ? 1 / A[0] : 1, rho_t = trace > 0 ? (m - 1) / trace : 1;
  if (!s.done()) contact_newton(s, rho_n, rho_t);
  if (!s.done() && m == 3 && b.parts == 1 && b.lo == 0 && b.hi == kInf && s.residual > 1e-10 * s.q.norm()) {
    contact_cases(s, blocks.parts(b)[0].mu);
    if (!s.done()) contact_newton(s, rho_n, rho_t);
  }
  if (s.residual > 1e-10 * s.q.norm()) contact_fixed_point(s, std::min(rho_n, rho_t) / 2);
  if (s.residual > 1e-10 * s.q.norm()) contact_newton(s, rho_n, rho_t);
  Eigen::Map<Eigen::VectorXd>(z, m) = s.best;
  return s.residual;
}

}  // namespace orthant
