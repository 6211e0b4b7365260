#include "experiments/studies/motion_storm/painleve.h"

#include "experiments/studies/motion_storm/closed_rows.h"
#include "experiments/studies/motion_storm/space.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace orthant::motion_storm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// P as above.
MatrixXd admittance(const ClosedRows& rows) {
  const MatrixXd free = rows.inverse_mass.asDiagonal();
  MatrixXd G(static_cast<Eigen::Index>(rows.joints.size()), rows.dof());
  for (std::size_t i = 0; i < rows.joints.size(); ++i) G.row(static_cast<Eigen::Index>(i)) = rows.joints[i];
  if (G.rows() == 0) return free;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> S(G * free * G.transpose());
  VectorXd inverse = S.eigenvalues();
  const double least = 1e-11 * inverse.maxCoeff();
  for (double& value : inverse) value = value > least ? 1 / value : 0;
  const MatrixXd H = free * G.transpose() * S.eigenvectors();
  return free - H * inverse.asDiagonal() * H.transpose();
}

/// Whether a principal minor of B is negative, B scaled to a unit diagonal.
bool negative_minor(const MatrixXd& B) {
  const Eigen::Index k = B.rows();
  for (int subset = 1; subset < 1 << k; ++subset) {
    std::vector<Eigen::Index> in;
    for (Eigen::Index i = 0; i < k; ++i)
      if ((subset >> i & 1) != 0) in.push_back(i);
    if (MatrixXd(B(in, in)).determinant() < -1e-9) return true;
  }
  return false;
}

/// Likewise one of order 1 or 2, of any of these σ; entry(i, j, σ_j) of k contacts.
template <class Entry, class Directions>
bool negative_pair(Eigen::Index k, const Entry& entry, const Directions& directions) {
  for (Eigen::Index i = 0; i < k; ++i)
    for (const auto& s : directions) {
      if (entry(i, i, s) < -1e-9) return true;
      for (Eigen::Index j = 0; j < i; ++j)
        for (const auto& t : directions)
          if (entry(i, i, s) * entry(j, j, t) - entry(i, j, t) * entry(j, i, s) < -1e-9) return true;
    }
  return false;
}

enum Mode { open, sticks, slides_up, slides_down };

/// Newton's law of impact at k contacts: rows 2i (normal) and 2i + 1 (tangent) of contact i, both scaled so that
/// A_NN = 1: then rates and impulses are in the same unit.
class ImpactProblem {
 public:
  struct Law {
    double mu = 0, mu_static = 0;
    bool optional = false;  // not quite closed
  };

  ImpactProblem(MatrixXd A, VectorXd b, std::vector<Law> laws)
      : A_(std::move(A)), b_(std::move(b)), laws_(std::move(laws)) {}

  /// Whether this mode (base 4, a digit a contact) solves it, or may.
  bool solves(int mode) const {
    const auto k = static_cast<Eigen::Index>(laws_.size());
    // Λ = S z: the unknowns z are normal impulses of closed contacts and tangent ones of those that stick.
    MatrixXd S = MatrixXd::Zero(2 * k, 2 * k);
    std::vector<Eigen::Index> zero;  // rows of w that vanish, one an unknown
    for (Eigen::Index i = 0; i < k; ++i) {
      const Mode m = digit(mode, i);
      const Law& law = laws_[static_cast<std::size_t>(i)];
      if (m == open) continue;
      if (m != sticks && !(std::max(law.mu, law.mu_static) > 0)) return false;
      S(2 * i, static_cast<Eigen::Index>(zero.size())) = 1;
      if (m != sticks) S(2 * i + 1, static_cast<Eigen::Index>(zero.size())) = m == slides_up ? -law.mu : law.mu;
      zero.push_back(2 * i);
      if (m == sticks && std::max(law.mu, law.mu_static) > 0) {
        S(2 * i + 1, static_cast<Eigen::Index>(zero.size())) = 1;
        zero.push_back(2 * i + 1);
      }
    }
    const auto n = static_cast<Eigen::Index>(zero.size());
    if (n == 0) return admissible(mode, VectorXd::Zero(2 * k));
    const MatrixXd all = A_ * S.leftCols(n), B = all(zero, Eigen::all);
    const VectorXd r = -b_(zero);
    for (const double singular : {kSlack, 1e-12}) {
      Eigen::CompleteOrthogonalDecomposition<MatrixXd> qr(n, n);
      qr.setThreshold(singular);
      qr.compute(B);
      const VectorXd z = qr.solve(r);  // the least one, of that rank
      const double most = std::max(b_.lpNorm<Eigen::Infinity>(), z.lpNorm<Eigen::Infinity>());
      const bool agree = qr.rank() == n || (B * z - r).lpNorm<Eigen::Infinity>() <= kSlack * most;
      if (agree && (qr.rank() < n - 1 ||
                    admissible_along(mode, S.leftCols(n) * z, S.leftCols(n) * kernel(B, n - qr.rank(), singular))))
        return true;
    }
    return false;
  }

 private:
  static constexpr double kSlack = 1e-6;  // of the fastest rate, the largest impulse and, for ranks, the largest pivot

  static Mode digit(int mode, Eigen::Index i) { return static_cast<Mode>(mode >> (2 * i) & 3); }

  /// Of rank n − 1 its kernel, of rank n zero.
  static VectorXd kernel(const MatrixXd& B, Eigen::Index missing, double singular) {
    if (missing == 0) return VectorXd::Zero(B.cols());
    Eigen::FullPivLU<MatrixXd> lu(B.rows(), B.cols());
    lu.setThreshold(singular);
    lu.compute(B);
    return lu.kernel().col(0).normalized();
  }

  /// Must not be negative; linear in the impulse and in the rates w.
  std::vector<double> signs(int mode, const VectorXd& impulse, const VectorXd& w) const {
    std::vector<double> all;
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(laws_.size()); ++i) {
      const Law& law = laws_[static_cast<std::size_t>(i)];
      const Mode m = digit(mode, i);
      const double normal = impulse[2 * i], tangent = impulse[2 * i + 1], slip = w[2 * i + 1];
      if (m == open && !law.optional) all.push_back(w[2 * i]);
      if (m != open) all.push_back(normal);
      if (m == sticks)
        for (const double side : {-1.0, 1.0}) all.push_back(std::max(law.mu, law.mu_static) * normal + side * tangent);
      if (m == slides_up) all.push_back(slip);
      if (m == slides_down) all.push_back(-slip);
    }
    return all;
  }

  bool admissible(int mode, const VectorXd& impulse) const {
    return admissible_along(mode, impulse, VectorXd::Zero(impulse.size()));
  }

  /// Whether impulse + s along is admissible for some s.
  bool admissible_along(int mode, const VectorXd& impulse, const VectorXd& along) const {
    const double slack = kSlack * std::max(b_.lpNorm<Eigen::Infinity>(), impulse.lpNorm<Eigen::Infinity>());
    const std::vector<double> at = signs(mode, impulse, A_ * impulse + b_), change = signs(mode, along, A_ * along);
    for (const double side : {-1.0, 1.0}) {
      double least = 0, most = std::numeric_limits<double>::infinity();  // of |s|
      for (std::size_t i = 0; i < at.size(); ++i) {
        const double x = at[i] + slack, by = side * change[i] + kSlack * along.lpNorm<Eigen::Infinity>();
        if (by > 0)
          least = std::max(least, -x / by);
        else if (by < 0)
          most = std::min(most, -x / by);
        else if (x < 0)
          most = -1;
      }
      if (least <= most) return true;
    }
    return false;
  }

  MatrixXd A_;
  VectorXd b_;  // rates without impulses − targets
  std::vector<Law> laws_;
};

}  // namespace

bool impact_impossible(const Scene& scene, const State& x, double gap) {
  constexpr std::size_t kMost = 5;
  constexpr double kTouching = 1e-9, kStrikes = 1e-9;  // [m], [m/s]
  if (scene.restitution != Restitution::newton || scene.impacts != Impacts::simultaneous) return false;
  const ClosedRows rows = closed_rows(scene, x, gap);
  const std::size_t k = rows.contacts.size();
  if (k == 0 || k > kMost) return false;
  const MatrixXd P = admittance(rows), free = rows.inverse_mass.asDiagonal();
  MatrixXd J = MatrixXd::Zero(static_cast<Eigen::Index>(2 * k), rows.dof());
  VectorXd b(J.rows());
  std::vector<ImpactProblem::Law> laws;
  for (const ClosedContactRows& c : rows.contacts) {
    const auto at = static_cast<Eigen::Index>(2 * laws.size());
    J.row(at) = c.normal, J.row(at + 1) = c.tangents[0];
    const VectorXd N = J.row(at);
    const double square = N.dot(P * N);
    if (!(square > 1e-9 * N.dot(free * N))) return false;
    J.middleRows(at, 2) /= std::sqrt(square);
    const ContactLaw& law = c.law;
    const double belt = law.belt / std::sqrt(square), normal = J.row(at).dot(x.v), slip = J.row(at + 1).dot(x.v) - belt;
    const bool strikes = normal * std::sqrt(square) < -kStrikes;
    b[at] = normal + law.e * normal;
    b[at + 1] = slip + (strikes ? law.e_t * slip : 0);
    laws.push_back({law.mu, law.mu_static, c.gap > kTouching});
  }
  const ImpactProblem problem(J * P * J.transpose(), b, std::move(laws));
  for (int mode = 0; mode < 1 << (2 * k); ++mode)
    if (problem.solves(mode)) return false;
  return true;
}

namespace {

/// Rows of the closed contacts that joints do not immobilise, scaled so that N P Nᵀ = 1.
template <class Space> struct Touching {
  MatrixXd P;
  std::vector<VectorXd> normal;
  std::vector<MatrixXd> tangents;  // columns
  std::vector<double> mu;

  Touching(const SceneOf<Space>& scene, const State& x, double gap) {
    const ClosedRows rows = closed_rows(scene, x, gap);
    const MatrixXd free = rows.inverse_mass.asDiagonal();
    P = admittance(rows);
    for (const ClosedContactRows& c : rows.contacts) {
      const VectorXd& N = c.normal;
      const double scale = N.dot(P * N);
      if (!(scale > 1e-9 * N.dot(free * N))) continue;
      normal.push_back(N / std::sqrt(scale)), tangents.emplace_back(rows.dof(), Space::kTangents);
      for (std::size_t i = 0; i < c.tangents.size(); ++i)
        tangents.back().col(static_cast<Eigen::Index>(i)) = c.tangents[i] / std::sqrt(scale);
      mu.push_back(std::max(c.law.mu, c.law.mu_static));
    }
  }
  /// B_ij, j sliding with σ.
  double operator()(Eigen::Index i, Eigen::Index j, int sigma) const {
    return (*this)(i, j, VectorXd::Constant(1, sigma));
  }
  double operator()(Eigen::Index i, Eigen::Index j, const VectorXd& sigma) const {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    return normal[a].dot(P * normal[b]) - mu[b] * normal[a].dot(P * tangents[b] * sigma);
  }
  /// The least B_ii of contact i over all directions.
  double least(Eigen::Index i) const {
    const auto a = static_cast<std::size_t>(i);
    return normal[a].dot(P * normal[a]) - mu[a] * (tangents[a].transpose() * P * normal[a]).norm();
  }
};

template <class Space> bool begins(const SceneOf<Space>& scene, const State& x, double gap) {
  const Touching<Space> B(scene, x, gap);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(B.normal.size()); ++i)
    if (B.least(i) < 1e-9) return true;
  return false;
}

}  // namespace

bool painleve_begins(const Scene& scene, const State& x, double gap) { return begins<Planar>(scene, x, gap); }
bool painleve_begins(const spatial::Scene& scene, const State& x, double gap) { return begins<Spatial>(scene, x, gap); }

bool painleve_possible(const Scene& scene, const State& x, double gap, bool many) {
  const Touching<Planar> entry(scene, x, gap);
  const auto k = static_cast<Eigen::Index>(entry.normal.size());
  if (k > 6) return many || negative_pair(k, entry, std::array{-1, 0, 1});
  for (int sign = 0; sign < static_cast<int>(std::pow(3, k)); ++sign) {
    MatrixXd B(k, k);
    for (Eigen::Index i = 0; i < k; ++i)
      for (Eigen::Index j = 0; j < k; ++j) B(i, j) = entry(i, j, sign / static_cast<int>(std::pow(3, j)) % 3 - 1);
    if (negative_minor(B)) return true;
  }
  return false;
}

bool painleve_possible(const spatial::Scene& scene, const State& x, double gap, bool many) {
  constexpr int kDirections = 16;
  const Touching<Spatial> entry(scene, x, gap);
  const auto k = static_cast<Eigen::Index>(entry.normal.size());
  if (many && k > 6) return true;
  std::vector<VectorXd> directions{VectorXd::Zero(2)};
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kDirections;
    directions.emplace_back(Vector2d(std::cos(angle), std::sin(angle)));
  }
  for (Eigen::Index i = 0; i < k; ++i)
    if (entry.least(i) < -1e-9) return true;
  return negative_pair(k, entry, directions);
}

bool impact_impossible(const spatial::Scene& scene, const State& x, double gap) {
  const auto contacts = closed_rows(scene, x, gap).contacts;
  return contacts.size() > 1 && std::ranges::any_of(contacts, [](const auto& c) { return c.law.frictional(); });
}

}  // namespace orthant::motion_storm
