// The scenes' exact answers, each against an integration of its own equation of motion or figures of 30 digits, and the
// drawings against the answers: a first-order run has to come near them.
#include "tests/support/runs.h"

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/elliptic.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/stick_slip.h>

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>

using namespace orthant;
using Eigen::VectorXd;

namespace {

constexpr double kPi = std::numbers::pi;

/// ẍ = a(t, x, ẋ) by the classical Runge-Kutta method.
template <class Acceleration>
void integrate(VectorXd& x, VectorXd& v, double t, double duration, int steps, Acceleration&& a) {
  const double h = duration / steps;
  for (int k = 0; k < steps; ++k, t += h) {
    const VectorXd a1 = a(t, x, v), v2 = v + h / 2 * a1;
    const VectorXd a2 = a(t + h / 2, VectorXd(x + h / 2 * v), v2), v3 = v + h / 2 * a2;
    const VectorXd a3 = a(t + h / 2, VectorXd(x + h / 2 * v2), v3), v4 = v + h * a3;
    const VectorXd a4 = a(t + h, VectorXd(x + h * v3), v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
}

template <class Acceleration> Motion integrate(Motion start, double t, double duration, Acceleration&& a) {
  VectorXd x = VectorXd::Constant(1, start.x), v = VectorXd::Constant(1, start.v);
  integrate(x, v, t, duration, 20000, [&](double at, const VectorXd& y, const VectorXd& w) {
    return VectorXd(VectorXd::Constant(1, a(at, y[0], w[0])));
  });
  return {x[0], v[0]};
}

void check_near(const Motion& a, const Motion& b, double tolerance) {
  CHECK(std::abs(a.x - b.x) <= tolerance);
  CHECK(std::abs(a.v - b.v) <= tolerance);
}

}  // namespace

TEST_CASE("bouncing ball: impact and Zeno times, flights between") {
  const BouncingBall half{.e = 0.5};
  CHECK(half.impact_time(1) == doctest::Approx(0.45152364098573090445).epsilon(1e-15));
  CHECK(half.zeno_time() == doctest::Approx(1.3545709229571927134).epsilon(1e-15));
  CHECK(half.at(1).x == doctest::Approx(0.061255565657545388491).epsilon(1e-14));
  CHECK(half.at(1.3).x == doctest::Approx(2.4163733329496484035e-4).epsilon(1e-11));
  CHECK(half.impacts(1) == 2);
  CHECK(half.impacts(1.3) == 5);
  check_near(half.at(half.zeno_time()), {0, 0}, 0);
  CHECK(BouncingBall{.e = 0.9}.zeno_time() == doctest::Approx(8.5789491787288871846).epsilon(1e-14));
  const BouncingBall elastic{.e = 1};
  CHECK(elastic.impact_time(10000) == doctest::Approx(9030.0212960736323581).epsilon(1e-15));
  CHECK(elastic.zeno_time() == kInf);
  check_near(elastic.at(2 * elastic.impact_time(1)), {1, 0}, 1e-14);
  check_near(BouncingBall{.e = 0}.at(0.5), {0, 0}, 0);
  for (const double t : {0.3, 0.7, 1.2}) {  // no jump of the position, and each flight is a fall
    const Motion later = half.at(t + 1e-5), now = half.at(t);
    CHECK((later.v - now.v) / 1e-5 == doctest::Approx(-kGravity).epsilon(1e-9));
    CHECK((later.x - now.x) / 1e-5 == doctest::Approx((later.v + now.v) / 2).epsilon(1e-9));
  }
}

TEST_CASE("impact oscillator: the periodic motion returns to itself and keeps off the wall") {
  constexpr double known[][3] = {
      // ω, phase, impact speed, by 25-digit arithmetic
      {1.4, 0.099194037644773469, 1.44420862262366902}, {1.6, 0.166108899259840035, 1.69585711141940579},
      {1.8, 0.33674530732932098, 2.65513624184740094},  {2.2, 2.80378657497214201, 1.89874873831130288},
      {2.4, 2.97050170261826799, 0.858441039501599774}, {2.6, 3.02938293575397531, 0.505439970893956763}};
  for (const auto& [omega, phase, speed] : known) {
    CAPTURE(omega);
    const ImpactOscillator p{.omega = omega};
    CHECK(p.phase() == doctest::Approx(phase).epsilon(1e-14));
    CHECK(p.impact_speed() == doctest::Approx(speed).epsilon(1e-14));
    const auto a = [&](double t, double x, double) { return std::cos(omega * t + phase) - x; };
    const Motion after{0, -p.e * speed};
    check_near(p.at(0), after, 1e-13);
    check_near(integrate(after, 0, p.period(), a), {0, speed}, 1e-11);
    check_near(integrate(after, 0, 0.4 * p.period(), a), p.at(3.4 * p.period()), 1e-11);
    for (int k = 1; k < 1000; ++k) CHECK(p.at(k * p.period() / 1000).x < 0);
  }
}

TEST_CASE("stick-slip: times, turning points, and the slip as its equation has it") {
  const StickSlip p;
  CHECK(p.stick_time() == doctest::Approx(5).epsilon(1e-15));
  CHECK(p.slip_time() == doctest::Approx(3.9026054078145230111).epsilon(1e-15));
  CHECK(p.period() == doctest::Approx(8.9026054078145230111).epsilon(1e-15));
  double least = 1, most = 0;
  for (int k = 0; k < 10000; ++k) {
    const double x = p.at(k * p.period() / 10000).x;
    least = std::min(least, x), most = std::max(most, x);
  }
  CHECK(least == doctest::Approx(-0.038516480713450403125).epsilon(1e-6));
  CHECK(most == doctest::Approx(1.0385164807134504031).epsilon(1e-6));
  for (const StickSlip& q :
       {p, StickSlip{.mass = 2, .stiffness = 3, .g = 9.81, .mu_static = 0.4, .mu = 0.1, .belt = 1}}) {
    const auto slide = [&](double, double x, double) { return q.mu * q.g - q.stiffness / q.mass * x; };
    const Motion start{q.mu_static * q.mass * q.g / q.stiffness, q.belt};
    check_near(q.at(q.stick_time() * (1 + 1e-15)), start, 1e-13);
    check_near(integrate(start, 0, 0.3 * q.slip_time(), slide), q.at(q.stick_time() + 0.3 * q.slip_time()), 1e-12);
    check_near(integrate(start, 0, q.slip_time(), slide), q.at(0), 1e-12);
  }
}

TEST_CASE("Coulomb decay: turning points, rest, and a half swing as its equation has it") {
  const CoulombDecay p;
  constexpr double turns[] = {10, -8.6, 7.2, -5.8, 4.4, -3, 1.6, -0.2};
  CHECK(p.half_swings() == 7);
  for (int n = 0; n < 8; ++n) CHECK(p.at(n * kPi * (1 + 1e-15)).x == doctest::Approx(turns[n]).epsilon(1e-13));
  check_near(p.at(100), {-0.2, 0}, 1e-14);
  CHECK(p.at(100).v == 0);
  for (const CoulombDecay& q : {p, CoulombDecay{.mass = 2, .stiffness = 5, .g = 9.81, .mu = 0.1, .start = -4}}) {
    const double begin = q.half_swing(), part = 0.7 * q.half_swing(), sign = q.start > 0 ? -1 : 1;
    const auto slide = [&](double, double x, double) { return sign * q.mu * q.g - q.stiffness / q.mass * x; };
    check_near(integrate({q.at(begin * (1 + 1e-15)).x, 0}, 0, part, slide), q.at(begin + part), 1e-11);
  }
  CHECK(CoulombDecay{.start = 0.5}.at(3).x == 0.5);
  check_near(CoulombDecay{.mu = 0}.at(2 * kPi), {10, 0}, 1e-13);
}

TEST_CASE("incline: distances and times of both directions, and what follows the stop") {
  const Incline up{.mu = 0.5, .speed = 2}, down{.mu = 0.8, .speed = -2};
  CHECK(up.stop_time() == doctest::Approx(0.21851106416401443953).epsilon(1e-15));
  CHECK(up.at(up.stop_time()).x == doctest::Approx(0.21851106416401443953).epsilon(1e-15));
  CHECK(up.at(up.stop_time() + 1).v == doctest::Approx(-0.65714539443732843762).epsilon(1e-14));
  CHECK(down.stop_time() == doctest::Approx(1.0573242237535353609).epsilon(1e-14));
  check_near(down.at(2), {-1.0573242237535353609, 0}, 1e-14);
  CHECK(Incline{.mu = 0.5, .speed = -2}.stop_time() == kInf);
  CHECK(Incline{.mu = 0.5, .mu_static = 0.6}.at(1).v == 0);
  check_near(Incline{.mu = std::tan(kPi / 6) - 1e-6, .speed = 0}.at(1),
             {-kGravity * std::cos(kPi / 6) * 0.5e-6, -kGravity * std::cos(kPi / 6) * 1e-6}, 1e-15);
}

TEST_CASE("elliptic functions: am inverts its integral") {
  for (const double k_prime : {1.0, 0.5, 0.0707}) {
    const double u = 1.3, phi = amplitude(u, k_prime), k2 = 1 - k_prime * k_prime;
    double sum = 0;
    const int n = 2000;  // Simpson
    for (int i = 0; i <= n; ++i) {
      const double s = std::sin(phi * i / n), weight = i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2;
      sum += weight / std::sqrt(1 - k2 * s * s);
    }
    CHECK(sum * phi / (3 * n) == doctest::Approx(u).epsilon(1e-12));
    CHECK(amplitude(quarter_period(k_prime), k_prime) == doctest::Approx(kPi / 2).epsilon(1e-14));
  }
}

TEST_CASE("pendulum: period and motion") {
  const Pendulum p;
  CHECK(p.period() == doctest::Approx(5.15806675426786591).epsilon(1e-14));
  const auto a = [](double, double theta, double) { return -kGravity * std::sin(theta); };
  for (const double t : {0.5, 2.0, 7.0}) check_near(integrate({3, 0}, 0, t, a), p.at(t), 1e-10);
  check_near(Pendulum{.angle = -1}.at(0), {-1, 0}, 1e-15);
}

TEST_CASE("chain: the constants, by an integration in the angles") {
  for (const ChainExact& exact : chain_exact()) {
    const int n = exact.links;
    const auto a = [&](double, const VectorXd& theta, const VectorXd& omega) {
      Eigen::MatrixXd M(n, n);
      VectorXd f(n);
      for (int i = 0; i < n; ++i) {
        f[i] = -kGravity * (n - i) * std::sin(theta[i]);
        for (int j = 0; j < n; ++j) {  // n − max(i, j) masses hang on both links
          const double shared = n - std::max(i, j);
          M(i, j) = shared * std::cos(theta[i] - theta[j]);
          f[i] -= shared * std::sin(theta[i] - theta[j]) * omega[j] * omega[j];
        }
      }
      return VectorXd(M.ldlt().solve(f));
    };
    VectorXd theta = VectorXd::Constant(n, kPi / 2), omega = VectorXd::Zero(n);
    integrate(theta, omega, 0, exact.t, 20000, a);
    Vector2d tip(0, 0);
    for (int i = 0; i < n; ++i) {
      CHECK(std::abs(theta[i] - exact.theta[i]) < 1e-9);
      tip += Vector2d(std::sin(theta[i]), -std::cos(theta[i]));
    }
    CHECK((tip - Vector2d(exact.tip[0], exact.tip[1])).norm() < 1e-9);
  }
}

TEST_CASE("N-four-bar: turn, motion, energy") {
  const NFourBar p;
  CHECK(p.turn_time() == doctest::Approx(1.9425149226070836835).epsilon(1e-14));
  CHECK(p.at(10).x == doctest::Approx(31.7505971869861018).epsilon(1e-12));
  CHECK(p.at(10).v == doctest::Approx(1.50664218084182947).epsilon(1e-11));
  CHECK(p.energy() == doctest::Approx(35.835).epsilon(1e-15));
  const auto a = [](double, double theta, double) { return 11.445 * std::sin(theta); };
  check_near(integrate({0, 1}, 0, 1.3, a), p.at(1.3), 1e-10);
  for (const int loops : {1, 2, 7}) {
    const NFourBar q{.loops = loops};
    const System system(n_four_bar(q));
    CHECK(energy(system, system.initial_state()) == doctest::Approx(q.energy()).epsilon(1e-14));
    CHECK(system.dof() - system.joint_rows() == 1);
  }
}

TEST_CASE("every built-in scene starts with its joints closed, at position and velocity level") {
  for (const SceneEntry& entry : scenes()) {
    CAPTURE(entry.name);
    const System system(entry.make({}));
    const State x = system.initial_state();
    Terms terms(system);
    set_poses(system, x.t, x.q, terms.at);
    evaluate_joint_residual(system, terms);
    evaluate_joint_rows(system, terms);
    if (system.joint_rows() > 0) CHECK(terms.phi.lpNorm<Eigen::Infinity>() < 1e-14);
    for (const Row& row : terms.G) CHECK(std::abs(apply(row, x.v.data())) < 1e-13);
  }
}

TEST_CASE("the drawings move as the exact answers do") {
  const auto end = [](Scene scene, double duration, double h = 1e-3) {
    scene.duration = duration;
    const Run r = run(scene, kSymmetric, h);
    REQUIRE(r.status == Status::solved);
    return r.final;
  };
  const auto check_coordinate = [](const State& x, Eigen::Index i, const Motion& exact, double tolerance) {
    check_near({x.q[i], x.v[i]}, exact, tolerance);
  };
  check_coordinate(end(bouncing_ball(), 1), 1, BouncingBall{}.at(1), 0.02);
  check_coordinate(end(impact_oscillator(), 10), 0, ImpactOscillator{}.at(10), 0.01);
  check_coordinate(end(stick_slip(), 16), 0, StickSlip{}.at(16), 0.01);
  check_coordinate(end(coulomb_decay(), 20), 0, CoulombDecay{}.at(20), 0.01);
  check_coordinate(end(incline(), 1), 0, Incline{}.at(1), 0.01);
  check_coordinate(end(incline({.mu = 0.3, .mu_static = 0.6, .speed = 1}), 1), 0,
                   Incline{.mu = 0.3, .mu_static = 0.6, .speed = 1}.at(1), 0.01);

  const State bob = end(pendulum(), 4);
  const double theta = Pendulum{}.at(4).x;
  CHECK(bob.q[0] == doctest::Approx(std::sin(theta)).epsilon(1e-3));
  CHECK(bob.q[1] == doctest::Approx(-std::cos(theta)).epsilon(1e-3));
  for (const ChainExact& exact : chain_exact()) {
    const State x = end(chain({.links = exact.links}), exact.t, 5e-4);
    CHECK((x.q.segment<2>(3 * (exact.links - 1)) - Vector2d(exact.tip[0], exact.tip[1])).norm() < 1e-2);
  }
  const State bars = end(n_four_bar(), 1.8);
  check_near({-bars.q[2], -bars.v[2]}, NFourBar{}.at(1.8), 1e-3);
}
