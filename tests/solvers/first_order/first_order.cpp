// First-order methods: psor, sgs, jacobi, nncg, apgd, mprgp, admm (pgs also has a file of its own).
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/pivoting/lemke.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <map>

#include "tests/solvers/first_order/first_order_runs.h"
#include "tests/support/allocations.h"
#include "tests/support/judge.h"

using namespace orthant;

namespace {

double radius(const Eigen::MatrixXd& iteration) { return iteration.eigenvalues().cwiseAbs().maxCoeff(); }

/// Tridiagonal (−1, 2 + shift, −1), sparse.
Lcp chain(Index n, double shift, const Vector& q) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2 + shift);
    if (i > 0) entries.emplace_back(i, i - 1, -1), entries.emplace_back(i - 1, i, -1);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  return Lcp::standard(RowSparse::from(M), q);
}

double energy(const Lcp& p, const Vector& z) {
  Vector Az, scratch;
  multiply(p.A, z, Az, scratch);
  return 0.5 * z.dot(Az) + z.dot(p.b);
}

}  // namespace

TEST_CASE("sweeps contract by the spectral radius of their iteration matrix") {
  Random random(51);
  for (int trial = 0; trial < 10; ++trial) {
    const Index n = random.integer(4, 9);
    Lcp p = random_spd_problem(n, random);
    const Eigen::MatrixXd A = std::get<DenseMatrix>(p.A), I = Eigen::MatrixXd::Identity(n, n);
    Vector z(Eigen::VectorXd::Zero(n));
    for (double& value : z) value = random.uniform(1, 2);
    p.b = -A * z;  // every row between its bounds
    const Eigen::MatrixXd D = A.diagonal().asDiagonal(), L = A.triangularView<Eigen::StrictlyLower>(),
                          U = A.triangularView<Eigen::StrictlyUpper>();
    const auto sor = [&](double omega) { return Eigen::MatrixXd(I - (D / omega + L).inverse() * A); };
    const auto back = [&](double omega) { return Eigen::MatrixXd(I - (D / omega + U).inverse() * A); };
    const Eigen::VectorXd root = A.diagonal().cwiseSqrt();
    const Eigen::VectorXd l1 = root.cwiseProduct(A.cwiseAbs() * root.cwiseInverse());
    const auto jacobi = [&](const Eigen::VectorXd& d, double omega) {
      return Eigen::MatrixXd(I - omega * d.cwiseInverse().asDiagonal() * A);
    };
    const struct {
      std::string spec;
      Eigen::MatrixXd iteration;
    } cases[] = {{"pgs:", sor(1)},
                 {"pgs:omega=0.8,", sor(0.8)},
                 {"psor:omega=0.7,", sor(0.7)},
                 {"sgs:", back(1) * sor(1)},
                 {"sgs:omega=1.2,", back(1.2) * sor(1.2)},
                 {"jacobi:", jacobi(l1, 1)},
                 {"jacobi:omega=1.5,", jacobi(l1, 1.5)},
                 {"jacobi:scaling=diagonal,omega=0.1,", jacobi(A.diagonal(), 0.1)}};
    for (const auto& [spec, iteration] : cases) {
      IterationLog log;
      const Solution s =
          solve(spec + "tolerance=1e-12,max_" + (spec[0] == 'j' ? "iterations" : "sweeps") + "=1000000", p, &log);
      INFO(spec, " n = ", n, ": ", log.size(), " iterations");
      REQUIRE(s.status == Status::solved);
      const double expected = radius(iteration);
      const Eigen::VectorXcd eigenvalues = iteration.eigenvalues();
      Index which = 0;
      eigenvalues.cwiseAbs().maxCoeff(&which);
      if (log.size() < 60 || eigenvalues[which].imag() != 0) continue;  // no tail to measure, or one that oscillates
      const std::size_t last = log.size() - 1, first = last - last / 4;
      const double measured = std::pow(log[last].merit / log[first].merit, 1.0 / static_cast<double>(last - first));
      CHECK(std::log(measured) / std::log(expected) == doctest::Approx(1).epsilon(0.02));
    }
  }
}

TEST_CASE("psor finds its omega: two blocks take the square root of the sweeps of Gauss-Seidel") {
  for (const double r : {100.0, 1e4, 1e6}) {
    DenseMatrix A(Eigen::Matrix2d{{1, -1}, {-1, 1 + 1 / r}});
    const Lcp p = Lcp::standard(A, Vector{-1, 0});
    const Solution s = solve("psor", p);
    INFO("r = ", r, ": ", s.iterations, " sweeps");
    CHECK(has_answer(s.status));
    CHECK(s.iterations < 60 * std::sqrt(r));
    CHECK(std::abs(s.z[0] - (r + 1)) < 1e-5 * r);
  }
  const Lcp p = string_on_obstacle(128);
  const Solution gs = solve("pgs", p), sor = solve("psor", p);
  REQUIRE(gs.status == Status::solved);
  REQUIRE(sor.status == Status::solved);
  INFO("string of 127: ", gs.iterations, " and ", sor.iterations);
  CHECK(sor.iterations * 5 < gs.iterations);
}

TEST_CASE("first-order methods agree with Lemke on symmetric positive definite problems with boxes") {
  Random random(52);
  for (int trial = 0; trial < 30; ++trial) {
    Lcp p = random_spd_problem(random.integer(1, 15), random);
    for (Index i = 0; i < p.size(); i += 3) p.lo[i] = -0.1, p.hi[i] = random.uniform(0, 0.2);
    for (Index i = 1; i < p.size(); i += 4) p.lo[i] = -kInf;
    const Solution truth = solve("lemke", p);
    REQUIRE(truth.status == Status::solved);
    for (const std::string& spec : kAll)
      for (const Lcp& stored : {p, as_sparse(p)}) {
        const Solution s = solve(spec, stored);
        INFO(spec, ", trial ", trial, ", n = ", p.size(), ": ", name(s.status), " after ", s.iterations);
        REQUIRE(s.status == Status::solved);
        CHECK((s.w - truth.w).lpNorm<Eigen::Infinity>() <= 1e-8 * p.b.lpNorm<Eigen::Infinity>());
        CHECK((s.z - truth.z).lpNorm<Eigen::Infinity>() <= 1e-6 * (1 + truth.z.lpNorm<Eigen::Infinity>()));
      }
  }
}

TEST_CASE("contacts with friction: three storages, one answer") {
  Random random(53);
  for (int trial = 0; trial < 20; ++trial) {
    const Lcp delassus = random_contact_problem(random.integer(1, 6), 30, 0.6, random);
    Lcp dense = delassus;
    DenseMatrix A;
    to_dense(delassus.A, A);
    dense.A = A;
    Vector z;
    for (const std::string& spec : kAll)
      for (const Lcp& p : {delassus, dense, as_sparse(dense)}) {
        const Solution s = solve(spec, p);
        INFO(spec, ", trial ", trial, ": ", name(s.status), " after ", s.iterations);
        REQUIRE(s.status == Status::solved);
        CHECK(independent_residual(p, s.z) < 1e-9);
        if (z.size() == 0) z = s.z;
        CHECK((s.z - z).lpNorm<Eigen::Infinity>() <= 1e-7 * (1 + z.lpNorm<Eigen::Infinity>()));
      }
  }
}

TEST_CASE("semidefinite problems, rank deficient and degenerate: w is the one there is") {
  Random random(54);
  std::map<std::string, int> missed;  // slow, where the condition is bad
  for (int trial = 0; trial < 20; ++trial) {
    const Index n = random.integer(5, 20), rank = random.integer(2, static_cast<int>(n));
    Eigen::MatrixXd B(rank, n);
    for (double& value : B.reshaped()) value = random.integer(-2, 2);
    for (Index j = 0; j < n; ++j) B(j % rank, j) += 5;  // no zero column
    const Eigen::MatrixXd M = B.transpose() * B;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n), w = z;
    for (Index i = 0; i < n; ++i)  // a third of the rows is degenerate
      if (i % 3 != 0) (i % 3 == 1 ? z : w)[i] = random.integer(1, 9);
    const Lcp p = Lcp::standard(DenseMatrix(M), Vector(w - M * z));
    for (const std::string& spec : kAll) {
      const Solution s = solve(spec, p);
      INFO(spec, ", trial ", trial, ": ", name(s.status), " after ", s.iterations);
      if (s.status == Status::solved)
        CHECK((s.w - w).lpNorm<Eigen::Infinity>() <= 1e-8 * p.b.lpNorm<Eigen::Infinity>());
      else
        ++missed[spec];
    }
  }
  for (const auto& [spec, times] : missed) {
    INFO(spec, ": ", times);
    CHECK((spec != "mprgp" && spec != "apgd" && times <= 2));
  }
}

TEST_CASE("the string on an obstacle: mprgp is exact, accelerated methods come close") {
  for (const Index n : {15, 63, 255}) {
    const Lcp p = string_on_obstacle(n + 1);
    Vector exact(Eigen::VectorXd::Zero(n));
    for (Index i = 0; i < n; ++i) {
      const double x = static_cast<double>(i + 1) / static_cast<double>(n + 1);
      exact[i] = 4 * std::pow(std::max({0.25 - x, x - 0.75, 0.0}), 2);
    }
    const Solution s = solve("mprgp:tolerance=1e-14", p);
    INFO("n = ", n, ": ", s.iterations);
    CHECK(s.status == Status::solved);
    CHECK((s.z - exact).lpNorm<Eigen::Infinity>() <= 1e-13 * static_cast<double>(n));
    CHECK(s.iterations <= 2 * n);
    const Solution a = solve("apgd", p);
    CHECK(a.status == Status::solved);
    CHECK((a.z - exact).lpNorm<Eigen::Infinity>() <= 1e-5);
  }
}

TEST_CASE("the journal bearing: the least energy, by mprgp, apgd, psor and admm") {
  const Lcp small = journal_bearing(8, 12);
  for (const std::string& spec : kAll) {
    const Solution s = solve(spec, small);
    INFO(spec, ": ", s.iterations);
    CHECK(s.status == Status::solved);
    CHECK(std::abs(energy(small, s.z) + 0.1834372196) < 1e-9);
  }
  const Lcp p = journal_bearing(50, 50);
  for (const std::string& spec : std::vector<std::string>{"mprgp", "apgd", "psor", "nncg", "admm"}) {
    const Solution s = solve(spec, p);
    INFO(spec, ": ", s.iterations);
    CHECK(s.status == Status::solved);
    CHECK(std::abs(energy(p, s.z) + 0.1804879950) < 1e-9);
    if (spec == "mprgp") CHECK((s.z.array() == 0).count() == 824);
  }
}

TEST_CASE("the ball obstacle: mprgp and psor find the contact nodes") {
  for (const auto& [intervals, contacts] : {std::pair{32, 109}, {64, 421}}) {
    const BallObstacle ball = ball_obstacle(intervals);
    for (const std::string& spec : std::vector<std::string>{"mprgp", "psor"}) {
      const Solution s = solve(spec, ball.problem);
      INFO(spec, ", ", intervals, " intervals: ", s.iterations);
      CHECK(s.status == Status::solved);
      CHECK((s.z.array() == 0).count() == contacts);
      CHECK((s.z - ball.exact).lpNorm<Eigen::Infinity>() < (intervals == 32 ? 6e-3 : 7e-4));
    }
  }
}

TEST_CASE("piles of boxes, redundant contacts with friction, mass ratios: solved by all") {
  const Lcp problems[] = {box_column(5, {}), box_column(3, {.mass_ratio = 100}), brick_wall(3, {}),
                          loaded_table(3, {.spatial = true}), box_column(3, {.spatial = true})};
  for (const std::string& spec : kAll) {
    int solved = 0;
    for (const Lcp& p : problems) {
      const Solution s = solve(spec, p);
      INFO(spec, ": ", name(s.status), " after ", s.iterations);
      if (s.status == Status::solved) CHECK(independent_residual(p, s.z) < 1e-9);
      CHECK(s.status != Status::infeasible);
      solved += s.status == Status::solved;
    }
    CHECK(solved == 5);
  }
}

TEST_CASE("a K-matrix of condition 4e5: mprgp ends after about n steps") {
  const Index n = 1000;
  const Solution s = solve("mprgp:tolerance=1e-12", chain(n, 0, Vector(Eigen::VectorXd::Constant(n, -1))));
  CHECK(has_answer(s.status));
  CHECK(s.iterations <= 2 * n);
  for (Index i = 0; i < n; i += 37)
    CHECK(s.z[i] == doctest::Approx(static_cast<double>((i + 1) * (n - i)) / 2).epsilon(1e-11));
}

TEST_CASE("mprgp is finite on positive definite problems, and its rate does not know the active set") {
  Random random(55);
  for (int trial = 0; trial < 50; ++trial) {  // integers: z, w exact, the residual falls to rounding
    const Lcp p = random_spd_problem(random.integer(2, 25), random);
    const Solution s = solve("mprgp:tolerance=1e-13", p);
    INFO("trial ", trial, ", n = ", p.size(), ": ", s.iterations);
    CHECK(has_answer(s.status));
    CHECK(s.iterations <= 12 * p.size());
  }
  for (const double share : {0.0, 0.3, 0.7, 1.0}) {  // of rows pushed on their bound
    int iterations[2] = {0, 0};
    for (const int k : {0, 1}) {
      const Index n = k == 0 ? 100 : 10000;
      Vector q(Eigen::VectorXd::Zero(n));
      for (double& value : q) value = random.uniform() < share ? random.uniform(0, 1) : -random.uniform(0, 1);
      const Solution s = solve("mprgp", chain(n, 1, q));
      CHECK(s.status == Status::solved);
      iterations[k] = s.iterations;
    }
    INFO("share ", share, ": ", iterations[0], ", ", iterations[1]);
    CHECK(iterations[1] <= 60);  // condition 5
    CHECK(iterations[1] <= 1.8 * iterations[0] + 5);
  }
}

TEST_CASE("mprgp: a ray of no curvature is a proof that there is no solution") {
  const Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, -1}, {-1, 1}}), Vector{-1, -1});
  const auto solver = make_solver("mprgp");
  solver->set_proof_search(false);
  Solution s;
  REQUIRE(solver->solve(p, s).status == Status::infeasible);
  CHECK(s.certificate == Eigen::Vector2d(1, 1));
}

TEST_CASE("admm: saddle points, unsymmetric monotone matrices, fixed and free rows") {
  Random random(56);
  for (int trial = 0; trial < 60; ++trial) {
    const Index n = random.integer(2, 12);
    const Known known = planted_problem(n, random.integer(1, static_cast<int>(n)), n, random);
    Lcp p = known.problem;
    if (trial % 2 == 0) p.lo[0] = p.hi[0] = 1;
    const Solution truth = solve("lemke", p);
    if (truth.status != Status::solved) continue;
    for (const Lcp& stored : {p, as_sparse(p)}) {
      const Solution s = solve("admm:max_iterations=100000", stored);
      INFO("trial ", trial, ", n = ", n, ": ", name(s.status), " after ", s.iterations);
      CHECK(s.status == Status::solved);
      CHECK(independent_residual(stored, s.z) < 1e-9);
    }
  }
}

TEST_CASE("jacobi: spectral steps are longer than those that allow for the worst signs, and find the same") {
  Random random(63);
  for (int trial = 0; trial < 5; ++trial) {
    const Lcp p = random_spd_problem(40, random);
    const Solution l1 = solve("jacobi", p), spectral = solve("jacobi:scaling=spectral", p);
    REQUIRE(l1.status == Status::solved);
    REQUIRE(spectral.status == Status::solved);
    CHECK((l1.z - spectral.z).lpNorm<Eigen::Infinity>() <= 1e-8);
    CHECK(3 * spectral.iterations < 2 * l1.iterations);
  }
}
