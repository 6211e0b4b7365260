// Joint rows eliminated: both equations hold, at any mass, and nothing stays of what was not finite.
#include <orthant/core/lcp/problems/families.h>
#include <orthant/core/mechanics/dynamics/schur.h>
#include <orthant/core/mechanics/dynamics/sparse_schur.h>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <utility>

using namespace orthant;

namespace {

/// n rows on n + 1 bodies, each on two of them; every third but for `near` the one before it.
std::vector<Row> random_rows(int n, double near, Random& random) {
  std::vector<Row> rows;
  for (int i = 0; i < n; ++i) {
    Row row{.a = i, .b = i % 4 == 3 ? kGround : i + 1, .ja = {}, .jb = {}};
    for (std::size_t k = 0; k < 3; ++k) row.ja[k] = random.normal(), row.jb[k] = random.normal();
    if (near > 0 && i % 3 == 2) {
      row = rows.back();
      for (double& entry : row.ja) entry += near * random.normal();
    }
    rows.push_back(row);
  }
  return rows;
}

Eigen::VectorXd normal_vector(Eigen::Index size, Random& random) {
  return Eigen::VectorXd::NullaryExpr(size, [&] { return random.normal(); });
}

/// The largest |G x − c| and, in accelerations, |M x − Gᵀ λ − f|.
double residual(std::span<const Row> rows, const Eigen::VectorXd& inverse_mass, const Eigen::VectorXd& f,
                const Eigen::VectorXd& c, const Eigen::VectorXd& x, const Eigen::VectorXd& lambda) {
  Eigen::VectorXd push = f;
  double worst = 0;
  for (Eigen::Index i = 0; i < c.size(); ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    apply_transposed(row, lambda[i], push.data());
    worst = std::max(worst, std::abs(apply(row, x.data()) - c[i]));
  }
  return std::max(worst, (x - inverse_mass.cwiseProduct(push)).lpNorm<Eigen::Infinity>());
}

}  // namespace

TEST_CASE(
    "joint rows eliminated: both equations hold for 0 to 12 rows, masses from 1e-250 to 1e250, nearly equal rows") {
  Random random(1);
  for (const double unit : {1e-250, 1e-160, 1e-150, 1.0, 1e150, 1e155, 1e160, 1e250})
    for (const double near : {0.0, 1e-3})
      for (int n = 0; n <= 12; ++n) {
        CAPTURE(unit);
        CAPTURE(near);
        CAPTURE(n);
        const std::vector<Row> rows = random_rows(n, near, random);
        const Eigen::Index dof = 3 * (n + 1);
        const Eigen::VectorXd inverse_mass = (1 + normal_vector(dof, random).array().square()) / unit;
        const Eigen::VectorXd f = unit * normal_vector(dof, random), c = normal_vector(n, random);
        Schur schur(inverse_mass, rows);
        REQUIRE(schur.factorize(rows, 1e-14));
        CHECK(schur.independence() > 1e-10);
        Eigen::VectorXd x(dof), lambda(n);
        schur.solve(f.data(), c.data(), x.data(), lambda.data());
        CHECK(residual(rows, inverse_mass, f, c, x, lambda) < 1e-9 * (1 + x.lpNorm<Eigen::Infinity>()));

        const Eigen::VectorXd v = normal_vector(dof, random);
        Eigen::VectorXd missing = c;
        for (Eigen::Index i = 0; i < n; ++i) missing[i] -= apply(rows[static_cast<std::size_t>(i)], v.data());
        schur.solve_change(f.data(), v.data(), c.data(), x.data(), lambda.data());
        CHECK(residual(rows, inverse_mass, f, missing, x, lambda) < 1e-9 * (1 + x.lpNorm<Eigen::Infinity>()));
      }
}

TEST_CASE("joint rows eliminated: equal rows are detected at any mass, and so are numbers that are not finite") {
  Random random(2);
  for (const double unit : {1e-250, 1e-155, 1.0, 1e155, 1e250})
    for (int n = 2; n <= 12; ++n) {
      std::vector<Row> rows = random_rows(n, 0, random);
      rows.back() = rows.front();
      const Eigen::VectorXd inverse_mass = Eigen::VectorXd::Constant(3 * (n + 1), 1 / unit);
      Schur schur(inverse_mass, rows);
      CHECK_FALSE(schur.factorize(rows, 1e-12));
      CHECK(schur.finite());
      rows.front().ja[1] = std::numeric_limits<double>::quiet_NaN();
      CHECK_FALSE(schur.factorize(rows, 1e-12));
      CHECK_FALSE(schur.finite());
    }
}

TEST_CASE("joint rows eliminated: after forces and rows that are not finite the next solution is as before") {
  Random random(3);
  for (int n = 1; n <= 12; ++n) {
    CAPTURE(n);
    const std::vector<Row> rows = random_rows(n, 0, random);
    const Eigen::Index dof = 3 * (n + 1);
    Schur schur(Eigen::VectorXd::Ones(dof), rows);
    REQUIRE(schur.factorize(rows, 1e-14));
    const Eigen::VectorXd f = normal_vector(dof, random), c = normal_vector(n, random);
    Eigen::VectorXd before(dof), after(dof), lambda(n);
    schur.solve(f.data(), c.data(), before.data(), lambda.data());
    const Eigen::VectorXd no_force = Eigen::VectorXd::Constant(dof, std::numeric_limits<double>::quiet_NaN());
    schur.solve(no_force.data(), c.data(), after.data(), lambda.data());
    schur.solve(f.data(), c.data(), after.data(), lambda.data());
    CHECK(after == before);
    Row no_row = rows.front();
    no_row.ja.fill(std::numeric_limits<double>::infinity());
    schur.solve_row(no_row, after.data());
    schur.solve(f.data(), c.data(), after.data(), lambda.data());
    CHECK(after == before);
  }
}

TEST_CASE("many joint rows eliminated: both equations hold at any mass, with results in place of what was given") {
  Random random(4);
  for (const double unit : {1e-150, 1e-6, 1.0, 1e6, 1e150})
    for (const double near : {0.0, 1e-3})
      for (const int n : {1, 2, 40, 400}) {
        CAPTURE(unit);
        CAPTURE(near);
        CAPTURE(n);
        std::vector<Row> rows = random_rows(n, near, random);
        const Eigen::Index dof = 3 * (n + 1);
        const auto schur = SparseSchurOf<Planar>::of(rows, n + 1);
        REQUIRE(schur != nullptr);
        for (int again = 0; again < 2; ++again) {
          const Eigen::VectorXd inverse_mass = (1 + normal_vector(dof, random).array().square()) / unit;
          const Eigen::VectorXd f = unit * normal_vector(dof, random), c = normal_vector(n, random);
          REQUIRE(schur->factorize(rows, inverse_mass, 1e-14));
          CHECK(schur->independence() > 1e-10);
          CHECK(schur->independence() <= 1);
          Eigen::VectorXd x = f, lambda = c;
          schur->solve(x.data(), lambda.data(), x.data(), lambda.data());
          CHECK(residual(rows, inverse_mass, f, c, x, lambda) < 1e-9 * (1 + x.lpNorm<Eigen::Infinity>()));
          for (Row& row : rows) row.ja[0] *= 1.5;
        }
      }
}

TEST_CASE("many joint rows eliminated: equal rows, numbers that are not finite and crowded bodies are refused") {
  Random random(5);
  const std::vector<Row> good = random_rows(50, 0, random);
  const Eigen::VectorXd inverse_mass = Eigen::VectorXd::Ones(3 * 51);
  const auto schur = SparseSchurOf<Planar>::of(good, 51);
  REQUIRE(schur != nullptr);
  std::vector<Row> rows = good;
  rows[1] = rows[0];
  CHECK_FALSE(schur->factorize(rows, inverse_mass, 1e-12));
  CHECK(schur->factorize_dependent());
  Eigen::VectorXd f = normal_vector(3 * 51, random), c = normal_vector(50, random);
  c[1] = c[0];
  Eigen::VectorXd x(3 * 51), lambda(50);
  schur->solve(f.data(), c.data(), x.data(), lambda.data());
  CHECK(residual(rows, inverse_mass, f, c, x, lambda) < 1e-10);
  for (Eigen::VectorXd* given : {&f, &c}) {
    const double kept = std::exchange((*given)[7], std::numeric_limits<double>::quiet_NaN());
    schur->solve(f.data(), c.data(), x.data(), lambda.data());
    CHECK(x.hasNaN());
    (*given)[7] = kept;
  }
  rows[1].ja[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(schur->factorize(rows, inverse_mass, 1e-12));
  CHECK_FALSE(schur->factorize_dependent());
  CHECK(schur->factorize(good, inverse_mass, 1e-12));
  rows.insert(rows.end(), good.begin(), good.end());
  CHECK(SparseSchurOf<Planar>::of(rows, 51) != nullptr);
  for (Row& row : rows) row.a = 0;  // S is full
  CHECK(SparseSchurOf<Planar>::of(rows, 51) == nullptr);
}

TEST_CASE("many joint rows eliminated: dependent ones share their forces by least squares, contradictions included") {
  Random random(6);
  for (const double unit : {1e-100, 1.0, 1e100})
    for (const double contradiction : {0.0, 1e-12, 1e-6, 1.0})
      for (const int n : {40, 200}) {
        CAPTURE(unit);
        CAPTURE(contradiction);
        CAPTURE(n);
        // Every third row a second and a third time, in other lengths; then one without entries.
        std::vector<Row> rows = random_rows(n, 0, random);
        Eigen::VectorXd c = normal_vector(n, random);
        const auto add = [&](Eigen::Index of, double by) {
          rows.push_back(scaled(rows[static_cast<std::size_t>(of)], by));
          c.conservativeResize(c.size() + 1);
          c[c.size() - 1] = by * c[of];
        };
        for (Eigen::Index i = 0; i < n; i += 3) add(i, 1), add(i, -3);
        add(0, 0);
        c += contradiction * normal_vector(c.size(), random);
        const Eigen::Index m = c.size(), dof = 3 * (n + 1);
        const auto schur = SparseSchurOf<Planar>::of(rows, n + 1);
        REQUIRE(schur != nullptr);
        const Eigen::VectorXd inverse_mass = (1 + normal_vector(dof, random).array().square()) / unit;
        const Eigen::VectorXd f = unit * normal_vector(dof, random);
        REQUIRE_FALSE(schur->factorize(rows, inverse_mass, 1e-9));
        REQUIRE(schur->factorize_dependent());
        CHECK(schur->rank() == n);

        // In rows of length 1, A = D^-1/2 G M^-1/2: the least of the least squares y of A y = D^-1/2 (c - G M^-1 f).
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(m, dof);
        Eigen::VectorXd length(m), missing(m);
        const Eigen::VectorXd free = inverse_mass.cwiseProduct(f);
        for (Eigen::Index i = 0; i < m; ++i) {
          const Row& row = rows[static_cast<std::size_t>(i)];
          each_entry(row,
                     [&](Eigen::Index place, double entry) { A(i, place) += entry * std::sqrt(inverse_mass[place]); });
          length[i] = A.row(i).norm() > 0 ? A.row(i).norm() : 1;
          A.row(i) /= length[i];
          missing[i] = (c[i] - apply(row, free.data())) / length[i];
        }
        const auto least_solution = [](const Eigen::MatrixXd& of, const Eigen::VectorXd& b) -> Eigen::VectorXd {
          Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> whole;
          whole.setThreshold(1e-7);
          return whole.compute(of).solve(b);
        };
        const Eigen::VectorXd y = least_solution(A, missing);
        const Eigen::VectorXd x_best = free + inverse_mass.cwiseSqrt().cwiseProduct(y);
        const Eigen::VectorXd share = least_solution(A.transpose(), y).cwiseQuotient(length);

        Eigen::VectorXd x = f, lambda = c;
        schur->solve(x.data(), lambda.data(), x.data(), lambda.data());
        CHECK((x - x_best).norm() < (1e-10 + 1e-7 * contradiction) * x_best.norm());
        CHECK((lambda - share).cwiseProduct(length).norm() <
              (1e-7 + contradiction) * share.cwiseProduct(length).norm());
      }
}
