// The slider-crank in nine coordinates against its equations of motion in three, contact forces included.
#include <doctest/doctest.h>
#include <orthant/core/scenes/slider_crank.h>

#include "tests/support/mechanics.h"

namespace orthant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::Draws;
using testing::MatrixXd;
using testing::mismatch;
using testing::VectorXd;

/// θ₁, θ₂, θ₃ and their rates.
struct Angles {
  Vector3d theta, omega;
};

/// The nine coordinates and velocities of the assembled mechanism.
State assembled(const SliderCrank& p, const Angles& a) {
  const auto along = [&](int i) { return Vector2d(std::cos(a.theta[i]), std::sin(a.theta[i])); };
  const Vector2d u1 = along(0), u2 = along(1), w1 = a.omega[0] * perp(u1), w2 = a.omega[1] * perp(u2);
  State x{.t = 0, .q = VectorXd(9), .v = VectorXd(9)};
  x.q << p.l1 / 2 * u1, a.theta[0], p.l1 * u1 + p.l2 / 2 * u2, a.theta[1], p.l1 * u1 + p.l2 * u2, a.theta[2];
  x.v << p.l1 / 2 * w1, a.omega[0], p.l1 * w1 + p.l2 / 2 * w2, a.omega[1], p.l1 * w1 + p.l2 * w2, a.omega[2];
  return x;
}

/// What a contact is in three coordinates: rates w_N · θ̇, w_T · θ̇ and their biases; the tangent is +x.
struct MinimalContact {
  Vector3d normal, tangent;
  double normal_bias = 0, tangent_bias = 0;
};

/// Corner at (ξ, η) in the slider; from g = d/2 ∓ (y_s + ξ s₃ + η c₃) and x = l₁ c₁ + l₂ c₂ + ξ c₃ − η s₃.
MinimalContact corner(const SliderCrank& p, const Angles& a, double xi, double eta) {
  const Vector3d s = a.theta.array().sin(), c = a.theta.array().cos(), w2 = a.omega.array().square();
  const Vector3d dy(p.l1 * c[0], p.l2 * c[1], xi * c[2] - eta * s[2]);
  const Vector3d dx(-p.l1 * s[0], -p.l2 * s[1], -xi * s[2] - eta * c[2]);
  // d²y/dt² at zero angular accelerations is dx · ω², and d²x/dt² is −dy · ω².
  const double side = eta > 0 ? -1 : 1;  // the top wall is above
  return {side * dy, dx, side * dx.dot(w2), -dy.dot(w2)};
}

struct MinimalEquations {
  Matrix3d M;
  Vector3d h;
};

MinimalEquations minimal(const Angles& a) {
  constexpr double M11 = 2.9650115e-3, M22 = 8.595878e-3, K = 4.44771e-3, J3 = 2.7e-6;
  constexpr double m1 = 0.038, m2 = 0.038, m3 = 0.076, l1 = 0.153, l2 = 0.306, g = 9.81;
  const double difference = a.theta[0] - a.theta[1], M12 = K * std::cos(difference), h12 = K * std::sin(difference);
  MinimalEquations e;
  e.M << M11, M12, 0, M12, M22, 0, 0, 0, J3;
  e.h << -h12 * a.omega[1] * a.omega[1] - (m1 / 2 + m2 + m3) * g * l1 * std::cos(a.theta[0]),
      h12 * a.omega[0] * a.omega[0] - (m2 / 2 + m3) * g * l2 * std::cos(a.theta[1]), 0;
  return e;
}

Angles random_angles(Draws& random) {
  const Vector3d theta(random(-3, 3), random(-1, 1), random(-0.05, 0.05));
  return {theta, {random(-150, 150), random(-100, 100), random(-10, 10)}};
}

struct Forces {
  VectorXd acceleration, normal;
};

/// W_N a + bias = 0 at the closed contacts with λ_T = −μ sign(γ_T) λ_N; `solve` is M⁻¹ or the basic system.
template <class Solve> Forces slide(Solve&& solve, const VectorXd& free, const MatrixXd& W_N, const MatrixXd& W_T,
                                    const VectorXd& bias, const VectorXd& slip, double mu) {
  const VectorXd direction = slip.cwiseSign();
  const MatrixXd pushed = (W_N - mu * direction.asDiagonal() * W_T).transpose();
  MatrixXd response(pushed.rows(), pushed.cols());
  for (Index i = 0; i < pushed.cols(); ++i) response.col(i) = solve(VectorXd(pushed.col(i)));
  const VectorXd lambda = (W_N * response).partialPivLu().solve(-bias - W_N * free);
  return {free + response * lambda, lambda};
}

}  // namespace

TEST_CASE("assembled: the pins hold, at rest and in motion") {
  for (int seed = 0; seed < 20; ++seed) {
    Draws random(static_cast<std::uint64_t>(seed));
    const System system(slider_crank());
    const State x = assembled({}, random_angles(random));
    const Terms terms = testing::all_terms(system, x.q, x.v);
    CHECK(terms.phi.lpNorm<Eigen::Infinity>() < 1e-15);
    CHECK((testing::dense(terms.G, 9) * x.v).lpNorm<Eigen::Infinity>() < 1e-13);
  }
  const System system(slider_crank());
  const State start = system.initial_state(), x = assembled({}, {{0, 0, 0}, {150, -75, 0}});
  CHECK(mismatch(start.q, x.q) < 1e-15);
  CHECK(mismatch(start.v, x.v) < 1e-15);
  CHECK(energy(system, start) == doctest::Approx(7.49554875).epsilon(1e-14));
}

TEST_CASE("gaps are those of the corners in three coordinates") {
  const SliderCrank p;
  Draws random(1);
  for (int i = 0; i < 20; ++i) {
    const Angles a = random_angles(random);
    const State x = assembled(p, a);
    const double y = p.l1 * std::sin(a.theta[0]) + p.l2 * std::sin(a.theta[1]), half = p.b + p.clearance;
    const double s3 = std::sin(a.theta[2]), c3 = std::cos(a.theta[2]);
    const Eigen::Vector4d expected(half - (y - p.a * s3 + p.b * c3), half - (y + p.a * s3 + p.b * c3),
                                   half + (y - p.a * s3 - p.b * c3), half + (y + p.a * s3 - p.b * c3));
    CHECK(mismatch(testing::all_terms(System(slider_crank(p)), x.q, x.v).gap, expected) < 1e-15);
  }
}

TEST_CASE("nine coordinates and three accelerate alike, with no corner, one, or both top corners sliding on the wall") {
  const double mu = 0.3;
  const SliderCrank p{.mu = mu};
  const System system(slider_crank(p));
  const Eigen::Vector2d corners[] = {{-p.a, p.b}, {p.a, p.b}, {-p.a, -p.b}, {p.a, -p.b}};
  const std::vector<std::vector<int>> cases = {{}, {0}, {1}, {2}, {3}, {0, 1}, {2, 3}};
  for (const auto& closed : cases)
    for (int seed = 0; seed < 25; ++seed) {
      CAPTURE(closed.size());
      CAPTURE(seed);
      Draws random(static_cast<std::uint64_t>(seed));
      Angles a = random_angles(random);
      if (closed.size() == 2) {  // flat on the wall, sliding along it
        a.theta[2] = a.omega[2] = 0;
        const double y = closed[0] == 0 ? p.clearance : -p.clearance;
        a.theta[1] = std::asin((y - p.l1 * std::sin(a.theta[0])) / p.l2);
        a.omega[1] = -a.omega[0] * p.l1 * std::cos(a.theta[0]) / (p.l2 * std::cos(a.theta[1]));
      }
      const State x = assembled(p, a);
      const Terms terms = testing::all_terms(system, x.q, x.v);
      const auto n = static_cast<Index>(closed.size());

      const MinimalEquations e = minimal(a);
      MatrixXd w_N(n, 3), w_T(n, 3);
      VectorXd w_bias(n), w_tangent_bias(n);
      MatrixXd W_N(n, 9), W_T(n, 9);
      VectorXd W_bias(n), W_tangent_bias(n), slip(n);
      for (Index i = 0; i < n; ++i) {
        const int k = closed[static_cast<std::size_t>(i)];
        const MinimalContact c = corner(p, a, corners[k].x(), corners[k].y());
        w_N.row(i) = c.normal, w_T.row(i) = c.tangent, w_bias[i] = c.normal_bias;
        const ContactRows& rows = terms.closed[static_cast<std::size_t>(k)].rows;
        W_N.row(i) = testing::dense(rows.normal, 9), W_T.row(i) = testing::dense(rows.tangent, 9);
        W_bias[i] = terms.contact_bias[static_cast<std::size_t>(k)].normal;
        slip[i] = apply(rows.tangent, x.v.data());
        const double sign = k < 2 ? -1 : 1;  // the tangent of the top wall, whose normal is down, is −x
        w_tangent_bias[i] = sign * c.tangent_bias, w_T.row(i) *= sign;
        W_tangent_bias[i] = terms.contact_bias[static_cast<std::size_t>(k)].tangent;
        CHECK(mismatch(apply(rows.normal, x.v.data()), c.normal.dot(a.omega)) < 1e-13);
        CHECK(mismatch(slip[i], w_T.row(i).dot(a.omega)) < 1e-13);
      }

      const auto M = e.M.partialPivLu();
      const Forces three = slide([&](const VectorXd& f) { return VectorXd(M.solve(f)); }, M.solve(e.h), w_N, w_T,
                                 w_bias, w_T * a.omega, mu);

      BasicSystem basic(system);
      REQUIRE(basic.factorize(system, terms));
      const VectorXd none = VectorXd::Zero(6);
      const Forces nine = slide([&](const VectorXd& f) { return testing::solve(basic, f, none).x; },
                                testing::solve(basic, terms.f, -terms.joint_bias).x, W_N, W_T, W_bias, slip, mu);

      // Round-off is that of the largest terms: centripetal accelerations, and forces of that size on the slider.
      const double largest = a.omega.cwiseAbs2().maxCoeff();
      const double scale = std::max(three.acceleration.lpNorm<Eigen::Infinity>(), largest);
      const Vector3d theta(nine.acceleration[2], nine.acceleration[5], nine.acceleration[8]);
      CHECK((theta - three.acceleration).lpNorm<Eigen::Infinity>() < 1e-13 * scale);
      if (n == 0) continue;
      const double force_scale = std::max(three.normal.lpNorm<Eigen::Infinity>(), p.m3 * p.l1 * largest);
      CHECK((nine.normal - three.normal).lpNorm<Eigen::Infinity>() < 1e-13 * force_scale);
      const VectorXd creep = W_T * nine.acceleration + W_tangent_bias,
                     expected = w_T * three.acceleration + w_tangent_bias;
      CHECK((creep - expected).lpNorm<Eigen::Infinity>() < 1e-13 * scale);
    }
}

TEST_CASE("the ideal mechanism: guide force on the slider at the start") {
  const System system(slider_crank_ideal());
  const State x = system.initial_state();
  const auto s = testing::accelerations(system, x.q, x.v);
  CHECK(s.lambda[6] == doctest::Approx(0.890051408).epsilon(1e-8));
  CHECK(std::abs(s.x[7]) < 1e-11);  // the slider stays on its line
}

}  // namespace orthant
