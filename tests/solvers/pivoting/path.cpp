#include <orthant/solvers/pivoting/path.h>

#include <orthant/core/lcp/problems/collection.h>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/support/allocations.h"
#include "tests/support/judge.h"
#include "tests/support/nonlinear.h"

using namespace orthant;

namespace {

/// Kojima and Shindo's problem, or Josephy's with two coefficients and a constant changed.
Mcp kojima_shindo(bool josephy) {
  const double a = josephy ? 3 : 10, b = josephy ? 3 : 9, c = josephy ? -1 : -9;
  return complementarity(
      4,
      [=](const Vector& x, Vector& F) {
        F[0] = 3 * x[0] * x[0] + 2 * x[0] * x[1] + 2 * x[1] * x[1] + x[2] + 3 * x[3] - 6;
        F[1] = 2 * x[0] * x[0] + x[0] + x[1] * x[1] + a * x[2] + 2 * x[3] - 2;
        F[2] = 3 * x[0] * x[0] + x[0] * x[1] + 2 * x[1] * x[1] + 2 * x[2] + b * x[3] + c;
        F[3] = x[0] * x[0] + 3 * x[1] * x[1] + 2 * x[2] + 3 * x[3] - 3;
      },
      [=](const Vector& x, DenseMatrix& J) {
        J.row(0) << 6 * x[0] + 2 * x[1], 2 * x[0] + 4 * x[1], 1, 3;
        J.row(1) << 4 * x[0] + 1, 2 * x[1], a, 2;
        J.row(2) << 6 * x[0] + x[1], x[0] + 4 * x[1], 2, b;
        J.row(3) << 2 * x[0], 6 * x[1], 2, 3;
      });
}

double natural_residual(const Mcp& p, const Vector& z) {
  Vector F;
  F.resize(p.size());
  p.F(z, F);
  return (z - (z - F).cwiseMax(p.lo).cwiseMin(p.hi)).lpNorm<Eigen::Infinity>();
}

/// Firms with cost c q + β/(β + 1) (L)^(−1/β) q^((β + 1)/β) in a market with the price (5000 / Q)^(1/γ).
struct Oligopoly {
  std::vector<double> c, L, beta;
  double gamma;

  Mcp problem() const {
    const auto n = static_cast<Index>(c.size());
    const auto price = [g = gamma](double Q) { return std::pow(5000 / Q, 1 / g); };
    return complementarity(
        n,
        [*this, price](const Vector& q, Vector& F) {
          const double Q = q.sum(), p = price(Q), slope = -p / (gamma * Q);
          for (Index i = 0; i < q.size(); ++i) F[i] = marginal(i, q[i]) - p - q[i] * slope;
        },
        [*this, price](const Vector& q, DenseMatrix& J) {
          const double Q = q.sum(), p = price(Q), slope = -p / (gamma * Q), bend = -slope * (1 + 1 / gamma) / Q;
          for (Index i = 0; i < q.size(); ++i) {
            J.row(i).setConstant(-slope - q[i] * bend);
            const auto k = static_cast<std::size_t>(i);
            J(i, i) += -slope + std::pow(q[i] / L[k], 1 / beta[k]) / (beta[k] * q[i]);
          }
        });
  }
  double marginal(Index i, double q) const {
    const auto k = static_cast<std::size_t>(i);
    return c[k] + std::pow(q / L[k], 1 / beta[k]);
  }
};

}  // namespace

TEST_CASE("path: Kojima-Shindo and Josephy from 100 starts, at most 20 steps each") {
  for (const bool josephy : {false, true}) {
    const Mcp p = kojima_shindo(josephy);
    Random random(60);
    Path path;
    Solution s;
    int failed = 0, most = 0, regular = 0;
    for (int k = 0; k < 100; ++k) {
      s.z.resize(4);
      for (double& e : s.z) e = random.uniform(0, 10);
      path.solve(p, s, Start::warm);
      most = std::max(most, s.iterations);
      const double root = std::sqrt(6.0) / 2;
      const bool first = (s.z - Eigen::Vector4d(root, 0, 0, 0.5)).lpNorm<Eigen::Infinity>() < 1e-6,
                 second = (s.z - Eigen::Vector4d(1, 0, 3, 0)).lpNorm<Eigen::Infinity>() < 1e-9;
      regular += second;
      const bool good = s.status == Status::solved && natural_residual(p, s.z) <= 1e-10 &&
                        (first || (second && !josephy)) && s.iterations <= 20;
      failed += !good;
    }
    MESSAGE((josephy ? "Josephy" : "Kojima-Shindo"), ": failed ", failed, " of 100, at most ", most, " steps, ",
            regular, " ended on the regular solution");
    CHECK(failed == 0);
  }
}

TEST_CASE("path: oligopolies of 5 and 10 firms") {
  // Murphy, Sherali & Soyster (1982), Harker (1984).
  const Oligopoly five{.c = {10, 8, 6, 4, 2}, .L = {5, 5, 5, 5, 5}, .beta = {1.2, 1.1, 1, 0.9, 0.8}, .gamma = 1.1};
  const Oligopoly ten{.c = {5, 3, 8, 5, 1, 3, 7, 4, 6, 3},
                      .L = {10, 10, 10, 10, 10, 10, 10, 10, 10, 10},
                      .beta = {1.2, 1, 0.9, 0.6, 1.5, 1, 0.7, 1.1, 0.95, 0.75},
                      .gamma = 1.2};
  for (const Oligopoly& market : {five, ten}) {
    const Mcp p = market.problem();
    Path path;
    Solution s;
    Random random(61);
    Vector first;
    for (int k = 0; k < 20; ++k) {
      s.z.resize(p.size());
      for (double& e : s.z) e = k == 0 ? 10.0 : random.uniform(1, 100);
      path.solve(p, s, Start::warm);
      REQUIRE(s.status == Status::solved);
      CHECK(natural_residual(p, s.z) < 1e-10);
      CHECK(s.iterations <= 20);
      if (k == 0) first = s.z;
      CHECK((s.z - first).lpNorm<Eigen::Infinity>() < 1e-8 * first.maxCoeff());
    }
    if (p.size() == 5) {
      // As published, to the digits given there.
      const Vector published{36.9325, 41.8181, 43.7066, 42.6592, 39.1790};
      CHECK((s.z - published).lpNorm<Eigen::Infinity>() < 1e-3);
    }
  }
}

TEST_CASE("path: an obstacle problem with a nonlinear load, sparse, of 2000 rows") {
  const Index n = 2000;
  const double h = 1.0 / static_cast<double>(n + 1);
  Mcp p;  // −u″ + u³ = −20 above the obstacle −0.5, on (0, 1)
  p.lo = Eigen::VectorXd::Constant(n, -0.5);
  p.hi = Eigen::VectorXd::Constant(n, kInf);
  p.F = [=](const Vector& u, Vector& F) {
    for (Index i = 0; i < n; ++i) {
      const double left = i > 0 ? u[i - 1] : 0, right = i + 1 < n ? u[i + 1] : 0;
      F[i] = 2 * u[i] - left - right + h * h * (u[i] * u[i] * u[i] + 20);
    }
  };
  p.jacobian = [=](const Vector& u, Matrix& J) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(i, i, 2 + 3 * h * h * u[i] * u[i]);
      if (i > 0) entries.emplace_back(i, i - 1, -1.0);
      if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
    }
    Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
    A.setFromTriplets(entries.begin(), entries.end());
    J = RowSparse::from(A);
  };
  Path path;
  Solution s;
  path.solve(p, s);
  REQUIRE(s.status == Status::solved);
  CHECK(natural_residual(p, s.z) < 1e-10);
  // Without u³ the string leaves the obstacle at √(2 · 0.5 / 20) from the ends; u³ ≤ 0.125 beside 20 moves that little.
  const auto contact = static_cast<double>((s.z.array() == -0.5).count());
  CHECK(std::abs(contact / n - (1 - 2 / std::sqrt(20.0))) < 2e-3);
  for (Index i = 0; i < n; ++i) CHECK(std::abs(s.z[i] - s.z[n - 1 - i]) < 1e-9);
}

TEST_CASE("path: free rows, boxes and both bounds of a nonlinear problem") {
  // min Σ e^{x_i} − c_i x_i with x₀ + x₁ + x₂ = 1 (multiplier y free), x in boxes.
  Mcp p = complementarity(
      4,
      [](const Vector& z, Vector& F) {
        const double c[] = {1, 20, 0.01};
        for (Index i = 0; i < 3; ++i) F[i] = std::exp(z[i]) - c[i] - z[3];
        F[3] = z[0] + z[1] + z[2] - 1;
      },
      [](const Vector& z, DenseMatrix& J) {
        for (Index i = 0; i < 3; ++i) J(i, i) = std::exp(z[i]), J(i, 3) = -1, J(3, i) = 1;
      });
  p.lo = Vector{-1, -1, -1, -kInf};
  p.hi = Vector{2, 2, 2, kInf};
  Path path;
  Solution s;
  path.solve(p, s);
  REQUIRE(s.status == Status::solved);
  // x₁ at its upper bound 2; x₀ + x₂ = −1: x₀ = t, e^t − 1 = e^{−1−t} − 0.01, a quadratic in e^t, t < 1, x₂ = −1 − t >
  // −1?
  const double E = (0.99 + std::sqrt(0.99 * 0.99 + 4 * std::exp(-1.0))) / 2, t = std::log(E);
  const double x2 = std::max(-1.0, -1 - t), x0 = -1 - x2;
  CHECK(s.z[1] == 2);
  CHECK(std::abs(s.z[0] - x0) < 1e-10);
  CHECK(std::abs(s.z[2] - x2) < 1e-10);
}

TEST_CASE("path: callbacks that return rubbish end honestly, malformed problems in words") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Path path;
  Solution s;
  for (const double bad : {nan, kInf, -kInf}) {
    path.solve(complementarity(
                   2, [=](const Vector&, Vector& F) { F.setConstant(bad); },
                   [](const Vector&, DenseMatrix& J) { J.setIdentity(); }),
               s);
    CHECK(s.status == Status::numerical_error);
    path.solve(complementarity(
                   2, [](const Vector& z, Vector& F) { F = z - Eigen::VectorXd::Ones(2); },
                   [=](const Vector&, DenseMatrix& J) { J.setConstant(bad); }),
               s);
    CHECK(s.status == Status::numerical_error);
  }
  // log: F is NaN on a part of the bounds only; a solution at 1 is still found from 1e-3 and from 30.
  const Mcp p = complementarity(
      1, [](const Vector& z, Vector& F) { F[0] = std::log(z[0]); },
      [](const Vector& z, DenseMatrix& J) { J(0, 0) = 1 / z[0]; });
  for (const double from : {1e-3, 30.0}) {
    s.z = Vector{from};
    path.solve(p, s, Start::warm);
    REQUIRE(s.status == Status::solved);
    CHECK(std::abs(s.z[0] - 1) < 1e-10);
  }
  Mcp q = kojima_shindo(false);
  q.hi = Vector{1, 2};
  CHECK_THROWS_WITH_AS(path.solve(q, s), "Mcp: hi has 2 entries: must be 4, as lo", std::invalid_argument);
  q = kojima_shindo(false);
  q.lo[2] = nan;
  CHECK_THROWS_AS(path.solve(q, s), std::invalid_argument);
  q = kojima_shindo(false);
  q.F = nullptr;
  CHECK_THROWS_AS(path.solve(q, s), std::invalid_argument);
  q = kojima_shindo(false);
  q.F = [](const Vector&, Vector& F) { F = Vector{1, 2}; };
  CHECK_THROWS_WITH_AS(path.solve(q, s), "Mcp: F gave 2 entries: must be 4", std::invalid_argument);
  q = kojima_shindo(false);
  q.jacobian = [](const Vector&, Matrix& J) { J = DenseMatrix(Eigen::MatrixXd::Identity(3, 4)); };
  CHECK_THROWS_WITH_AS(path.solve(q, s), "Mcp: jacobian gave 3 x 4: must be 4 x 4", std::invalid_argument);
  for (const int column : {-1, 4, 1000000}) {
    q.jacobian = [column](const Vector&, Matrix& J) {
      RowSparse rows = RowSparse::from(Eigen::MatrixXd::Identity(4, 4).sparseView());
      rows.column[2] = column;
      J = rows;
    };
    CHECK_THROWS_AS(path.solve(q, s), std::invalid_argument);
  }
  // F in large units: an exact zero is one, whatever rounding its terms could have.
  const Mcp r = complementarity(
      1, [](const Vector& z, Vector& F) { F[0] = 1e8 * (z[0] - 1000.1); },
      [](const Vector&, DenseMatrix& J) { J(0, 0) = 1e8; });
  s.z = Vector{1000.1};
  CHECK(path.solve(r, s, Start::warm).status == Status::solved);
}

TEST_CASE("path: no row's rounding excuses another") {
  const Mcp p = complementarity(  // F_2 < 0 everywhere; F_1 of 1e9 rounds by 1e-7
      2, [](const Vector& z, Vector& F) { F[0] = 1e9 * (z[0] - 1), F[1] = -1e-6; },
      [](const Vector&, DenseMatrix& J) { J(0, 0) = 1e9, J(0, 1) = J(1, 0) = J(1, 1) = 0; });
  Path path;
  Solution s;
  path.solve(p, s);
  CHECK(s.status != Status::solved);
  CHECK(s.residual >= 0.99e-6);
}

TEST_CASE("path: a system without a solution is not called solved") {
  const Mcp p = complementarity(
      1, [](const Vector& z, Vector& F) { F[0] = -1 - z[0] * z[0]; },
      [](const Vector& z, DenseMatrix& J) { J(0, 0) = -2 * z[0]; });
  Path path;
  Solution s;
  path.solve(p, s);
  CHECK(s.status != Status::solved);
  CHECK(s.status != Status::infeasible);
  CHECK(s.residual >= 1);
}

TEST_CASE("path allocates nothing from the second linear problem of a size on") {
  Random random(62);
  std::vector<Lcp> problems;
  for (int k = 0; k < 10; ++k) problems.push_back(stewart_trinkle_problem(1 + k % 4, 0.5, 10, random));
  for (int k = 0; k < 10; ++k) problems.push_back(random_contact_problem(1 + k % 3, 6, 0.5, random));
  for (const Known& k : known_problems())
    if (k.name == "kkt" || k.name == "kkt_redundant" || k.name == "box") problems.push_back(k.problem);
  Path path;
  Solution s;
  for (const Lcp& p : problems) {
    path.solve(p, s);
    CHECK(s.status == Status::solved);
  }
  const std::size_t before = AllocationCount::now();
  for (const Lcp& p : problems) path.solve(p, s);
  CHECK(AllocationCount::now() == before);
}

TEST_CASE("path: a large sparse obstacle problem with a pivot a node at most, warm in one step") {
  // A18: −u″ + 8 ≥ 0, u ≥ −1/4: in contact from 1/4 to 3/4, the discrete answer exact at the nodes.
  const int n = 4095;
  const double h = 1.0 / (n + 1);
  std::vector<Eigen::Triplet<double>> entries;
  Lcp p;
  p.b.resize(n);
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2.0);
    if (i > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
    p.b[i] = 8 * h * h;
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  p.A = RowSparse::from(A);
  p.lo = Eigen::VectorXd::Constant(n, -0.25);
  p.hi = Eigen::VectorXd::Constant(n, kInf);
  Path path;
  Solution s;
  path.solve(p, s);
  REQUIRE(s.status == Status::solved);
  double error = 0;
  for (int i = 0; i < n; ++i) {
    const double x = std::min(h * (i + 1), 1 - h * (i + 1)),
                 exact = x < 0.25 ? -0.25 + 4 * (x - 0.25) * (x - 0.25) : -0.25;
    error = std::max(error, std::abs(s.z[i] - exact));
  }
  CHECK(error < 1e-13 * n);
  CHECK(s.iterations <= n);
  path.solve(p, s, Start::warm);
  CHECK(s.status == Status::solved);
  CHECK(s.iterations <= 1);
}
