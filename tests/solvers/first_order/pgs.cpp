#include <orthant/solvers/first_order/pgs.h>

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/pivoting/lemke.h>

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/allocations.h"
#include "tests/support/judge.h"

using namespace orthant;

namespace {

/// A block of mass m carries one of mass r m; both rest, b = −m g h per contact in velocities. As a Delassus operator:
/// W = [1 0; −1 1], contact 1 with the floor, 2 between the blocks; impulses ((r + 1), r) m g h.
Lcp two_blocks(double r) {
  Delassus A;
  Eigen::MatrixXd W(2, 2);
  W << 1, 0, -1, 1;
  A.W = RowSparse::from(W.sparseView());
  A.inverse_mass = Vector{1, 1 / r};
  Lcp p = Lcp::standard(A, Vector{-1, 0});  // free fall: both at −g h, relative velocity 0
  return p;
}

}  // namespace

TEST_CASE("a heavy block on a light one: sweeps as the factor r/(1+r) predicts") {
  const struct {
    double r;
    int sweeps;
  } table[] = {{1, 27}, {10, 194}, {100, 1852}, {1e4, 184217}};  // to 1e-8
  for (const auto& [r, sweeps] : table) {
    Pgs pgs(PgsOptions{.tolerance = 1e-8, .max_sweeps = 1000000});
    Solution s;
    pgs.solve(two_blocks(r), s);
    INFO("r = ", r, ": ", s.iterations, " sweeps");
    CHECK(s.status == Status::solved);
    // The residual starts lower than the error, by about 1/(1+r): fewer sweeps by the logarithm of that at most.
    const double saved = std::log(1 + r) / std::log1p(1 / r);
    CHECK(s.iterations <= 1.1 * sweeps);
    CHECK(s.iterations >= 0.9 * sweeps - saved);
  }
}

TEST_CASE("the contraction factor of two blocks is r/(1+r), sweep by sweep") {
  for (const double r : {1.0, 10.0, 100.0}) {
    Pgs pgs(PgsOptions{.tolerance = 1e-12});
    IterationLog log;
    pgs.set_log(&log);
    Solution s;
    pgs.solve(two_blocks(r), s);
    REQUIRE(log.size() > 25);
    for (std::size_t k = 10; k < 25; ++k)
      CHECK(log[k].merit / log[k - 1].merit == doctest::Approx(r / (1 + r)).epsilon(1e-6));
  }
}

TEST_CASE("the contraction factor of a column of n equal blocks is cos^2(pi/2n)") {
  for (const int n : {2, 3, 5, 10, 20}) {
    Delassus A;  // row k between blocks k and k − 1: only the lowest contact closes at first
    Eigen::MatrixXd W = Eigen::MatrixXd::Identity(n, n);
    for (int k = 1; k < n; ++k) W(k, k - 1) = -1;
    A.W = RowSparse::from(W.sparseView());
    A.inverse_mass = Vector(Eigen::VectorXd::Ones(n));
    Vector b(Eigen::VectorXd::Zero(n));
    b[0] = -1;
    Pgs pgs(PgsOptions{.tolerance = 1e-12});
    IterationLog log;
    pgs.set_log(&log);
    Solution s;
    pgs.solve(Lcp::standard(A, b), s);
    REQUIRE(s.status == Status::solved);
    for (int k = 0; k < n; ++k) CHECK(s.z[k] == doctest::Approx(n - k).epsilon(1e-9));  // what it carries
    const double pi = std::acos(-1.0), factor = std::pow(std::cos(pi / (2 * n)), 2);
    const std::size_t last = log.size() - 1, first = last / 2;
    const double measured = std::pow(log[last].merit / log[first].merit, 1.0 / static_cast<double>(last - first));
    INFO("n = ", n, ": ", measured, " for ", factor);
    CHECK(measured == doctest::Approx(factor).epsilon(n == 2 ? 1e-6 : 2e-3));
  }
}

TEST_CASE("PGS: the three storages take the same sweeps to the same answer") {
  Random random(41);
  for (int trial = 0; trial < 100; ++trial) {
    const Lcp delassus = random_contact_problem(random.integer(1, 6), 30, 0.6, random);
    Lcp dense = delassus;
    DenseMatrix A;
    to_dense(delassus.A, A);
    dense.A = A;
    Pgs pgs;
    Solution d, s, w;
    pgs.solve(dense, d);
    pgs.solve(as_sparse(dense), s);
    pgs.solve(delassus, w);
    INFO("trial ", trial, ": ", d.iterations, " sweeps");
    CHECK(d.status == Status::solved);
    CHECK(s.status == Status::solved);
    CHECK(w.status == Status::solved);
    CHECK(std::abs(d.iterations - w.iterations) <= 1);
    CHECK((d.z - w.z).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + d.z.lpNorm<Eigen::Infinity>()));
    CHECK((d.z - s.z).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + d.z.lpNorm<Eigen::Infinity>()));
    CHECK(independent_residual(delassus, w.z) < 1e-9);
  }
}

TEST_CASE("PGS and Lemke agree on symmetric positive definite problems") {
  Random random(42);
  for (int trial = 0; trial < 50; ++trial) {
    const Lcp p = random_spd_problem(random.integer(1, 15), random);
    Pgs pgs;
    Lemke lemke;
    Solution s, t;
    pgs.solve(p, s);
    lemke.solve(p, t);
    REQUIRE(s.status == Status::solved);
    REQUIRE(t.status == Status::solved);
    CHECK((s.w - t.w).lpNorm<Eigen::Infinity>() <= 1e-8 * p.b.lpNorm<Eigen::Infinity>());
  }
}

TEST_CASE("PGS: a start at the solution takes a sweep or two, a bad one is forgotten") {
  Random random(43);
  const Lcp p = random_contact_problem(4, 20, 0.4, random);
  Pgs pgs;
  Solution s;
  pgs.solve(p, s);
  REQUIRE(s.status == Status::solved);
  const int cold = s.iterations;
  const Vector z = s.z;
  pgs.solve(p, s, Start::warm);
  CHECK(s.iterations <= 2);
  CHECK(cold > 5);
  for (const double value : {-1e3, 1e3, std::numeric_limits<double>::quiet_NaN()}) {
    s.z.setConstant(value);
    pgs.solve(p, s, Start::warm);
    REQUIRE(s.status == Status::solved);
    CHECK((s.z - z).lpNorm<Eigen::Infinity>() < 1e-7 * z.lpNorm<Eigen::Infinity>());
  }
}

TEST_CASE("PGS says which diagonal entry it cannot divide by") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::Vector3d(1, 1, -2).asDiagonal().toDenseMatrix()), Vector{1, 1, 1});
  const std::string reason = Pgs().why_not(p);
  CHECK(reason.find("(2, 2)") != std::string::npos);
  CHECK(reason.find("-2") != std::string::npos);
  Solution s;
  CHECK(Pgs().solve(p, s).status == Status::unsupported);
}

TEST_CASE("PGS allocates nothing from the second problem of a size on") {
  Random random(44);
  std::vector<Lcp> problems;
  for (int k = 0; k < 6; ++k) problems.push_back(random_contact_problem(1 + k % 3, 12, 0.5, random));
  problems.push_back(as_sparse(problems.back()));
  problems.push_back(random_spd_problem(5, random));
  Pgs pgs;
  Solution s;
  for (const Lcp& p : problems) pgs.solve(p, s);
  const std::size_t before = AllocationCount::now();
  for (const Lcp& p : problems) pgs.solve(p, s);
  CHECK(AllocationCount::now() == before);
}
