// tests/support/mechanics.h — random mechanisms, and what their tests measure with.
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/support/random.h>

#include <Eigen/Dense>
#include <cstdint>

namespace orthant::testing {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The same numbers from the same seed with every standard library.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : random_(seed) {}
  double operator()(double low, double high) { return random_.uniform(low, high); }
  Vector2d point(double size = 1) { return {(*this)(-size, size), (*this)(-size, size)}; }
  Vector2d direction() {
    const double angle = (*this)(-3, 3);
    return {std::cos(angle), std::sin(angle)};
  }
  VectorXd vector(Index n, double size = 1) {
    return VectorXd::NullaryExpr(n, [&] { return (*this)(-size, size); });
  }

 private:
  Random random_;
};

/// A row as the long vector it stands for.
inline VectorXd dense(const Row& row, int dof) {
  VectorXd long_row = VectorXd::Zero(dof);
  apply_transposed(row, 1.0, long_row.data());
  return long_row;
}

inline MatrixXd dense(const std::vector<Row>& rows, int dof) {
  MatrixXd G(static_cast<Index>(rows.size()), dof);
  for (Index i = 0; i < G.rows(); ++i) G.row(i) = dense(rows[static_cast<std::size_t>(i)], dof);
  return G;
}

/// Everything at (t, q, v), all contacts closed.
inline Terms all_terms(const System& system, const VectorXd& q, const VectorXd& v, double t = 0) {
  Terms terms(system);
  set_poses(system, t, q, terms.at);
  set_twists(system, v, terms.at);
  evaluate_forces(system, t, v, terms);
  evaluate_joint_residual(system, terms);
  evaluate_joint_rows(system, terms);
  evaluate_gaps(system, terms);
  evaluate_closed(system, std::numeric_limits<double>::infinity(), terms);
  evaluate_biases(system, terms);
  return terms;
}

/// d/ds f at s = 0, central: error h²/6 f''' + ε f / h.
template <class F> auto central_difference(F&& f, double h = 1e-5) {
  using Value = std::decay_t<decltype(f(0.0))>;
  const Value ahead = f(h), behind = f(-h);
  return Value((ahead - behind) / (2 * h));
}

/// |a − b| against 1 + |b|: the tests' numbers are of the order of 1.
inline double mismatch(double a, double b) { return std::abs(a - b) / (1 + std::abs(b)); }
inline double mismatch(const VectorXd& a, const VectorXd& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  if (a.size() == 0) return 0;
  return (a - b).lpNorm<Eigen::Infinity>() / (1 + b.lpNorm<Eigen::Infinity>());
}

/// [ M + Σ row (k_weight k + c_weight c) rowᵀ, −Gᵀ ; G, 0 ] by its definition.
inline MatrixXd saddle_matrix(const System& system, const Terms& terms, double k_weight = 0, double c_weight = 0) {
  const Index n = system.dof(), m = system.joint_rows();
  MatrixXd K = MatrixXd::Zero(n + m, n + m);
  K.topLeftCorner(n, n).diagonal() = system.mass();
  for (std::size_t i = 0; i < terms.springs.size(); ++i) {
    const VectorXd row = dense(terms.springs[i].row, system.dof());
    const double weight = std::visit([&](const auto& s) { return k_weight * s.stiffness + c_weight * s.damping; },
                                     system.scene().springs[i]);
    K.topLeftCorner(n, n) += weight * row * row.transpose();
  }
  const MatrixXd G = dense(terms.G, system.dof());
  K.topRightCorner(n, m) = -G.transpose();
  K.bottomLeftCorner(m, n) = G;
  return K;
}

/// K⁻¹ rhs in 80-bit arithmetic, K regular.
inline VectorXd solve_precisely(const MatrixXd& K, const VectorXd& rhs) {
  using Precise = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  return Eigen::PartialPivLU<Precise>(K.cast<long double>()).solve(rhs.cast<long double>()).cast<double>();
}

struct SaddleSolution {
  VectorXd x, lambda;
};

inline SaddleSolution solve(const BasicSystem& basic, const VectorXd& f, const VectorXd& c) {
  SaddleSolution s{VectorXd(f.size()), VectorXd(c.size())};
  basic.solve(f.data(), c.data(), s.x.data(), s.lambda.data());
  return s;
}

/// Accelerations of the mechanism without contact, G a = −Ġ v.
inline SaddleSolution accelerations(const System& system, const VectorXd& q, const VectorXd& v,
                                    double stiffness_weight = 0) {
  const Terms terms = all_terms(system, q, v);
  BasicSystem basic(system);
  if (!basic.factorize(system, terms, stiffness_weight)) return {};
  return solve(basic, terms.f, -terms.joint_bias);
}

}  // namespace orthant::testing
