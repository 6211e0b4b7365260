// Active set and semismooth Newton on distributed rows: answers of the serial solvers, equal bits, ends in words.
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/distributed/distributed_newton.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/distributed/parts.h"

#include <chrono>
#include <cstring>

using namespace orthant;
using namespace orthant::distributed;

namespace {

using Method = NewtonOptions::Method;

struct Outcome {
  NewtonSolution s;
  Vector z;  // whole
  IterationLog log;
};
/// Every iteration was the active set's: no block made it hand over to the semismooth method.
bool reduced_throughout(const IterationLog& log) {
  for (const LogEntry& entry : log)
    if (entry.event != "block" && entry.event != "single") return false;
  return !log.empty();
}
Outcome solve(const Lcp& problem, NewtonOptions options = {}, double time_limit = kInf) {
  const DistributedLcp rows = DistributedLcp::from(MPI_COMM_WORLD, problem);
  DistributedNewton newton(rows, options);
  newton.set_time_limit(time_limit);
  Outcome out;
  newton.set_log(&out.log);
  newton.solve(out.s);
  if (out.s.z.size() == rows.rows()) out.z = whole_of(rows, out.s.z);
  return out;
}

Solution serial(const std::string& spec, const Lcp& problem) {
  const auto solver = make_solver(spec);
  solver->set_proof_search(false);
  Solution s;
  solver->solve(problem, s);
  return s;
}

/// The judge of one process sees the whole of the answer.
Status judged(const Lcp& problem, const Vector& z) {
  Judge judge;
  Solution s;
  s.z = z;
  judge.certify(problem, 1e-10, Claim::candidate, s);
  return s.status;
}

double distance(const Vector& x, const Vector& y) {
  return (x - y).lpNorm<Eigen::Infinity>() / (1 + y.lpNorm<Eigen::Infinity>());
}

}  // namespace

TEST_CASE("distributed newton: obstacle problems as the serial solvers have them, by both methods") {
  const std::vector<Lcp> problems{ball_obstacle(32).problem, journal_bearing(31, 20), elastic_plastic_torsion(30, 41),
                                  space_obstacle(10).problem, string_on_obstacle(64)};
  std::vector<PcName> pcs{PcName::hypre, PcName::automatic, PcName::gamg, PcName::additive_schwarz};
  for (const Lcp& problem : problems) {
    const Solution exact = serial("multigrid", problem), also = serial("auto", problem);
    REQUIRE(exact.status == Status::solved);
    REQUIRE(also.status == Status::solved);
    for (const Method method : {Method::reduced_space, Method::semismooth})
      for (const PcName pc : pcs) {
        NewtonOptions options;
        options.method = method, options.pc = pc;
        const Outcome out = solve(problem, options);
        INFO("rank ", rank_of_this(), ": ", problem.size(), " rows, method ", static_cast<int>(method), ", pc ",
             static_cast<int>(pc), ": ", name(out.s.status), " ", out.s.reason, " ", words_of(out.s.miss));
        REQUIRE(has_answer(out.s.status));
        CHECK(judged(problem, out.z) == out.s.status);
        CHECK(distance(out.z, exact.z) < 1e-7);
        CHECK(distance(out.z, also.z) < 1e-7);
        CHECK(out.s.iterations <= 60);
        CHECK(reduced_throughout(out.log) == (method == Method::reduced_space));
      }
    pcs.resize(1);  // the others on the first problem alone
  }
}

TEST_CASE("distributed newton: boxes, free rows, unsymmetric, rows in units apart") {
  Random random(11);
  for (int trial = 0; trial < 12; ++trial) {
    const auto [problem, z] = planted(random.integer(1, 60), trial % 2 == 0 ? 1 : 10, random);
    for (const Method method : {Method::reduced_space, Method::semismooth}) {
      NewtonOptions options;
      options.method = method;
      const Outcome out = solve(problem, options);
      INFO("rank ", rank_of_this(), ", trial ", trial, ", n = ", problem.size(), ", method ", static_cast<int>(method),
           ": ", name(out.s.status), " ", out.s.reason, " ", words_of(out.s.miss));
      REQUIRE(has_answer(out.s.status));
      CHECK(judged(problem, out.z) == out.s.status);
      CHECK(distance(out.z, z) < 1e-6);
      if (method == Method::reduced_space) CHECK(reduced_throughout(out.log));
    }
  }
}

TEST_CASE("distributed newton: a circulant P-matrix on which the active set alone cycles") {
  DenseMatrix M(Eigen::MatrixXd::Zero(3, 3));
  for (Index i = 0; i < 3; ++i) M(i, i) = 1, M((i + 1) % 3, i) = 2;
  const Lcp problem = Lcp::standard(M, Vector{-1, -1, -1});  // z = (1, 1, 1) / 3
  for (const int patience : {0, 1, 10}) {
    NewtonOptions options;
    options.patience = patience;
    const Outcome out = solve(problem, options);
    CHECK(out.s.status == Status::solved);
    CHECK(distance(out.z, Vector{1.0 / 3, 1.0 / 3, 1.0 / 3}) < 1e-12);
    CHECK(reduced_throughout(out.log));
  }
  // From the sides of this start the blocks {0, 2}, {1, 2}, {0, 1} follow each other without end.
  const DistributedLcp rows = DistributedLcp::from(MPI_COMM_WORLD, problem);
  for (const int patience : {0, 1, 10}) {
    NewtonOptions options;
    options.patience = patience;
    DistributedNewton newton(rows, options);
    IterationLog log;
    newton.set_log(&log);
    NewtonSolution s;
    s.z.resize(rows.rows());
    for (Index i = 0; i < rows.rows(); ++i) s.z[i] = rows.first() + i == 0 ? 5 : 0;
    newton.solve(s, true);
    CHECK(s.status == Status::solved);
    CHECK(reduced_throughout(log));
    CHECK(s.iterations > patience);
  }
}

TEST_CASE("distributed newton: the same bits again, and through a second solve of the same object") {
  const Lcp problem = ball_obstacle(40).problem;
  for (const Method method : {Method::reduced_space, Method::semismooth}) {
    NewtonOptions options;
    options.method = method;
    const Outcome first = solve(problem, options), second = solve(problem, options);
    REQUIRE(first.z.size() == problem.size());
    CHECK(std::memcmp(first.z.data(), second.z.data(), at(first.z.size()) * sizeof(double)) == 0);
    CHECK(first.s.krylov_iterations == second.s.krylov_iterations);
  }
}

TEST_CASE("distributed newton: no solution, an unbounded one, a singular matrix: a status and its reason") {
  const Lcp infeasible = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Constant(1, 1, -1)), Vector{-1});
  Lcp zero = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Zero(7, 7)), Vector(Eigen::VectorXd::Constant(7, -1)));
  Lcp free = zero;
  free.lo.setConstant(-kInf);
  const Lcp none_on_grid = [] {  // -(membrane) pushed without end: no z ≥ 0 has w ≥ 0
    Lcp p = string_on_obstacle(40);
    auto& A = std::get<RowSparse>(p.A);
    for (double& value : A.value) value = -value;
    p.b.setConstant(-8);
    return p;
  }();
  for (const Lcp* problem :
       {&infeasible, static_cast<const Lcp*>(&zero), static_cast<const Lcp*>(&free), &none_on_grid})
    for (const Method method : {Method::reduced_space, Method::semismooth}) {
      NewtonOptions options;
      options.method = method;
      const Outcome out = solve(*problem, options);
      INFO(problem->size(), " rows, method ", static_cast<int>(method), ": ", name(out.s.status));
      CHECK_FALSE(has_answer(out.s.status));
      CHECK(out.s.status != Status::not_run);
      CHECK(out.s.miss.row >= 0);
    }
}

TEST_CASE("distributed newton: time limit, iteration limit, cancellation end all ranks") {
  const Lcp problem = ball_obstacle(200).problem;
  const auto begin = std::chrono::steady_clock::now();
  CHECK(solve(problem, {}, 1e-3).s.status == Status::time_limit);
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 20);
  NewtonOptions one;
  one.max_iterations = 1;
  CHECK(solve(problem, one).s.status == Status::iteration_limit);
  const DistributedLcp rows = DistributedLcp::from(MPI_COMM_WORLD, problem);
  DistributedNewton newton(rows, {});
  const std::atomic<bool> raised = rank_of_this() == ranks_of_all() - 1;  // on the last rank alone
  newton.set_cancel(&raised);
  NewtonSolution s;
  newton.solve(s);
  CHECK(s.status == Status::cancelled);
}
