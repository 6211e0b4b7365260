// interior-point: monotone problems, exactly; catalogue cases; proofs; warm start; obstacles of 256² nodes.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/active_set/interior_point.h>
#include <orthant/solvers/linear_algebra/sparse_cholesky.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <chrono>

#include "tests/support/allocations.h"
#include "tests/support/judge.h"

using namespace orthant;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// BᵀB (+ skew), B rank × n with a third of its entries, rows of all kinds; with a solution, half of it degenerate, or
/// with any b.
Lcp monotone_problem(Index n, Index rank, bool skew, bool solvable, Random& random) {
  MatrixXd B = MatrixXd::Zero(rank, n);
  for (double& value : B.reshaped())
    if (random.integer(0, 2) == 0) value = random.normal();
  MatrixXd M = B.transpose() * B;
  M = (M + M.transpose()).eval() / 2;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i && skew; ++j) {
      const double value = random.integer(0, 3) == 0 ? random.normal() : 0;
      M(i, j) += value, M(j, i) -= value;
    }
  Lcp p = Lcp::standard(DenseMatrix(M), Vector(VectorXd::Zero(n)));
  VectorXd z(n), w = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const int kind = random.integer(0, 4);
    if (kind == 1 || kind == 3) p.lo[i] = -kInf;
    if (kind == 1) p.hi[i] = random.normal();
    if (kind == 2) p.lo[i] = random.normal(), p.hi[i] = p.lo[i] + std::max(0.0, random.uniform(-0.2, 2));
    const int place = random.integer(0, 3);
    z[i] = std::clamp(random.normal(), p.lo[i], p.hi[i]);
    if (place >= 2 && p.lo[i] > -kInf) z[i] = p.lo[i], w[i] = place == 2 ? random.uniform() : 0;
    if (place == 1 && p.hi[i] < kInf) z[i] = p.hi[i], w[i] = -random.uniform();
    p.b[i] = random.normal();
  }
  if (solvable) p.b = w - M * z;
  return p;
}

/// Frictionless contacts beyond the freedoms: W M⁻¹ Wᵀ of rank `dof`, with a solution.
Lcp delassus_problem(Index contacts, Index dof, Random& random) {
  Lcp p = random_contact_problem(contacts, dof, 0, random);  // its even rows
  Delassus& A = std::get<Delassus>(p.A);
  Vector z(VectorXd::Zero(2 * contacts)), w, scratch;
  for (Index i = 0; i < z.size(); ++i)
    if (random.integer(0, 2) == 0) z[i] = random.uniform();
  p.lo.setZero();
  p.friction.clear();
  multiply(A, z, w, scratch);
  for (Index i = 0; i < z.size(); ++i)
    p.b[i] = (z[i] == 0 && random.integer(0, 1) == 0 ? random.uniform() : 0.0) - w[i];
  return p;
}

double seconds(const auto& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

TEST_CASE("interior-point: planted problems, degenerate and rank deficient: all solved, as planted") {
  Random random(300);
  InteriorPoint solver;
  Solution s;
  for (int k = 0; k < 1000; ++k) {
    const Index n = random.integer(1, 12), rank = random.integer(0, static_cast<int>(n));
    const Known known = planted_problem(n, rank, random.integer(0, static_cast<int>(n)), random);
    INFO("problem ", k, ", n = ", n);
    solver.solve(k % 2 == 0 ? known.problem : as_sparse(known.problem), s);
    REQUIRE(has_answer(s.status));
    REQUIRE(independent_residual(known.problem, s.z) < 1e-13);
    // The solutions of a monotone problem share (A + Aᵀ) z; with a skew part not w.
    const auto& A = std::get<DenseMatrix>(known.problem.A);
    const VectorXd off = A * (s.z - known.z) + A.transpose() * (s.z - known.z);
    REQUIRE(off.lpNorm<Eigen::Infinity>() <= 1e-10 * (1 + known.problem.b.norm()));
  }
  for (const Index strict : {200, 180, 100}) {
    const Known known = planted_problem(200, 100, strict, random);
    solver.solve(known.problem, s);
    CHECK(s.status == Status::solved);
    CHECK(independent_residual(known.problem, s.z) < 1e-13);
    CHECK(s.iterations <= 25);
  }
}

TEST_CASE("interior-point: free rows, bounds, boxes, with and without skew part, rank deficient: solved to rounding") {
  InteriorPoint solver;
  Solution s;
  int missed = 0;
  for (const bool skew : {false, true}) {
    Random random(99);
    for (int k = 0; k < 300; ++k) {
      const Index n = random.integer(1, 30);
      const Lcp p = monotone_problem(n, random.integer(0, static_cast<int>(n)), skew, true, random);
      INFO("problem ", k, ", n = ", n, skew ? ", skew part" : "");
      for (const Lcp& stored : {p, as_sparse(p)}) {
        solver.solve(stored, s);
        missed += s.status != Status::solved;  // some row's own rounding level was not reached: stalled, and says so
        if (s.status == Status::solved) REQUIRE(independent_residual(p, s.z) < 1e-12);
      }
    }
  }
  MESSAGE("missed ", missed, " of 1200");
  CHECK(missed <= 6);
}

TEST_CASE("interior-point proves infeasibility from its own ray") {
  InteriorPoint solver;
  solver.set_proof_search(false);
  Solution s, expected;
  int infeasible = 0, missed = 0, contested = 0;
  Random random(99);
  for (int k = 0; k < 200; ++k) {
    const Index n = random.integer(1, 20);
    const Lcp p = monotone_problem(n, random.integer(0, static_cast<int>(n)), false, false, random);
    INFO("problem ", k, ", n = ", n);
    solver.solve(p, s);
    if (s.status == Status::solved) continue;
    if (has_few_cells(p)) {  // a matrix singular but for its last digits: solved by some 1e16
      const SolutionSet all = enumerate_solutions(p);
      if (all.isolated.size() + all.faces.size() > 0) {
        CHECK(s.status != Status::infeasible);
        continue;
      }
    }
    infeasible += s.status == Status::infeasible;
    missed += s.status != Status::infeasible;
    if (k % 4 > 0) continue;
    make_solver("lemke")->solve(p, expected);
    contested += expected.status != Status::infeasible;
    CHECK((expected.status == Status::infeasible || expected.status == Status::rounded));
  }
  MESSAGE(infeasible, " proved, ", missed, " not");
  CHECK(infeasible > 50);
  CHECK(contested <= 2);  // 1: singular but for its last digits, where no proof is exact
  CHECK(missed <= 24);    // 22: a proof is exact, and these rays are not
}

TEST_CASE("interior-point: frictionless contacts beyond the freedoms are solved, as a dense matrix or as rows") {
  Random random(7);
  InteriorPoint solver;
  Solution s;
  for (int k = 0; k < 200; ++k) {
    const Lcp p = delassus_problem(random.integer(1, 20), random.integer(1, 12), random);
    INFO("problem ", k);
    solver.solve(p, s);
    REQUIRE(s.status == Status::solved);
    REQUIRE(independent_residual(p, s.z) < 1e-12);
  }
  // A chain of 400 bodies, each pressed on the next by two equal contacts: sparse, rank 400 of 800.
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < 800; ++i) {
    entries.emplace_back(i, i / 2, 1.0);
    if (i / 2 > 0) entries.emplace_back(i, i / 2 - 1, -1.0);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> W(800, 400);
  W.setFromTriplets(entries.begin(), entries.end());
  Delassus A;
  A.W = RowSparse::from(W);
  A.inverse_mass = VectorXd::Ones(400);
  VectorXd b = VectorXd::Zero(800);
  b.head(2).setConstant(-1);  // all come to rest: level k carries 400 − k
  const Lcp p = Lcp::standard(A, Vector(b));
  solver.solve(p, s);
  CHECK(s.status == Status::solved);
  CHECK(s.residual < 1e-12);
  // μ = 0: the tangential rows are 0 and no obstacle.
  Lcp frictionless = random_contact_problem(3, 6, 0, random);
  CHECK(solver.why_not(frictionless).empty());
  solver.solve(frictionless, s);
  CHECK(s.status == Status::solved);
  frictionless.friction[0].mu = 0.5;
  CHECK(solver.solve(frictionless, s).status == Status::unsupported);
}

TEST_CASE("interior-point: obstacles with known answers") {
  InteriorPoint solver;
  Solution s;
  for (const Index intervals : {16, 64, 256}) {  // the discrete answer is exact
    solver.solve(string_on_obstacle(intervals), s);
    CHECK(s.status == Status::solved);
    for (Index i = 0; i < intervals - 1; ++i) {
      const double x = static_cast<double>(i + 1) / static_cast<double>(intervals),
                   lift = std::max({0.25 - x, x - 0.75, 0.0});
      REQUIRE(std::abs(s.z[i] - 4 * lift * lift) <= 1e-13 * static_cast<double>(intervals));
    }
  }
  for (const auto& [intervals, contacts, error] :
       {std::tuple<Index, Index, double>{32, 109, 5.75e-3}, {64, 421, 6.0e-4}}) {
    const BallObstacle ball = ball_obstacle(intervals);
    solver.solve(ball.problem, s);
    CHECK(s.status == Status::solved);
    CHECK((s.z.array() == 0).count() == contacts);
    CHECK((s.z - ball.exact).lpNorm<Eigen::Infinity>() < 1.01 * error);
  }
  for (const auto& [nx, ny, least] :
       {std::tuple<Index, Index, double>{8, 12, -0.1834372196}, {50, 50, -0.1804879950}}) {
    const Lcp bearing = journal_bearing(nx, ny);
    solver.solve(bearing, s);
    CHECK(s.status == Status::solved);
    CHECK(std::abs(0.5 * s.z.dot(s.w + bearing.b) - least) < 1e-9);
  }
}

TEST_CASE("interior-point: a warm start with the right sides costs one crossover; a wrong one changes no answer") {
  Random random(12);
  InteriorPoint solver;
  IterationLog log;
  solver.set_log(&log);
  Solution s;
  const Lcp p = random_spd_problem(30, random);
  REQUIRE(solver.solve(p, s).status == Status::solved);
  CHECK(s.iterations > 1);
  const Vector answer = s.z;
  s.z *= 1.01;
  CHECK(solver.solve(p, s, Start::warm).status == Status::solved);
  CHECK(s.iterations == 0);
  REQUIRE(log.size() == 1);
  CHECK(log[0].event == "crossover");
  for (int k = 0; k < 20; ++k) {
    for (double& value : s.z) value = std::abs(random.normal()) * random.integer(0, 1);
    CHECK(solver.solve(p, s, Start::warm).status == Status::solved);
    CHECK((s.z - answer).norm() <= 1e-12 * answer.norm());
  }
}

TEST_CASE("interior-point: the options are read; time and cancellation end it; the second solve allocates nothing") {
  Random random(13);
  Lcp p = random_spd_problem(20, random);
  Solution s;
  const auto plain = make_solver("interior-point:crossover=false,tolerance=1e-6");
  IterationLog log;
  plain->set_log(&log);
  CHECK(plain->solve(p, s).status == Status::solved);
  for (const LogEntry& entry : log) CHECK(entry.event.empty());
  CHECK(make_solver("interior-point:max_iterations=1")->solve(p, s).status == Status::iteration_limit);
  const auto solver = make_solver("interior-point");
  solver->solve(p, s);
  const std::size_t before = AllocationCount::now();
  solver->solve(p, s);
  CHECK(AllocationCount::now() == before);
  solver->set_time_limit(0);
  CHECK(solver->solve(p, s).status == Status::time_limit);
  solver->set_time_limit(kInf);
  const std::atomic<bool> cancel = true;
  solver->set_cancel(&cancel);
  CHECK(solver->solve(p, s).status == Status::cancelled);
}

TEST_SUITE("slow") {
  TEST_CASE("interior-point: 1000 planted rows, half of them degenerate") {
    Random random(8);
    const Known known = planted_problem(1000, 500, 500, random);
    Solution s;
    const double time = seconds([&] { InteriorPoint().solve(known.problem, s); });
    MESSAGE(s.iterations, " iterations, ", time, " s, residual ", s.residual);
    CHECK(s.status == Status::solved);
    CHECK(independent_residual(known.problem, s.z) < 1e-12);
  }

  TEST_CASE("interior-point: ball obstacle on 256 x 256 nodes, to block-pivot's residual, in the work of 30 systems") {
    const Lcp p = ball_obstacle(257).problem;
    Vector x = p.b;
    SparseCholesky cholesky;
    const double once = seconds([&] {
      CHECK(cholesky.factorize(std::get<RowSparse>(p.A), 1e-14));
      CHECK(cholesky.solve(x));
    });
    InteriorPoint solver;
    IterationLog log;
    solver.set_log(&log);
    Solution s, pivoted;
    const double time = seconds([&] { solver.solve(p, s); });
    make_solver("block-pivot")->solve(p, pivoted);
    MESSAGE(s.iterations, " iterations, ", log.size(), " log entries, ", time, " s = ", time / once,
            " times one factorization and solve (", once, " s)");
    CHECK(s.status == Status::solved);
    CHECK(s.residual <= 2 * pivoted.residual);
    CHECK((s.z - pivoted.z).lpNorm<Eigen::Infinity>() < 1e-12);
    CHECK(s.iterations + 6 < 30);
  }
}
