// Every solver ends when its time is over or the caller raises the flag, wherever in its work that finds it.
#include <orthant/core/lcp/problems/families.h>
#include <orthant/core/support/options.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>
#include <Eigen/LU>

#include <atomic>
#include <chrono>
#include <thread>

#include "experiments/support/clock.h"
#include "tests/support/sanitized.h"

using namespace orthant;

namespace {

/// [s] of the processor, which a busy machine does not lengthen.
template <class Work> double seconds_of(Work&& work) {
  const double begin = rival::processor_time();
  work();
  return rival::processor_time() - begin;
}

/// [s] until the solver ends by its limit; and by a flag that is raised as long after it began.
double limited(Solver& solver, const Lcp& problem, double limit, Solution& s) {
  solver.set_time_limit(limit);
  const double seconds = seconds_of([&] { solver.solve(problem, s); });
  solver.set_time_limit(kInf);
  return seconds;
}

double cancelled(Solver& solver, const Lcp& problem, double after, Solution& s, std::atomic<bool>& flag) {
  solver.set_cancel(&flag);
  return seconds_of([&] {
    const std::jthread other([&] {
      std::this_thread::sleep_for(std::chrono::duration<double>(after));
      flag = true;
    });
    solver.solve(problem, s);
  });
}

Lcp family_problem(const char* family, Index size, double hardness) {
  return find_family(family)->make(size, hardness, 1).problem;
}

/// For each solver a problem that it takes, and works on for long: seconds to days.
struct Long {
  const char* spec;
  Lcp problem;
};
std::vector<Long> long_work() {
  Eigen::Matrix2d slow;  // a light block under one of 1e9 its mass
  slow << 1, -1, -1, 1 + 1e-9;
  const Lcp blocks = Lcp::standard(DenseMatrix(slow), Vector{-1, 0});
  Eigen::MatrixXd skew(20, 20);  // without a solution, which no choice of sides shows early
  Random random(1);
  for (double& value : skew.reshaped()) value = random.normal();
  skew = (skew - skew.transpose()).eval();
  constexpr Index kFaces = 20,
                  kDimension = 12;  // the first solutions found are a polyhedron of many vertices, off z = 0
  Lcp polyhedron = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Zero(kFaces + kDimension, kFaces + kDimension)),
                                 Vector(Eigen::VectorXd::Zero(kFaces + kDimension)));
  for (Index i = 0; i < kFaces; ++i) {
    auto normal = std::get<DenseMatrix>(polyhedron.A).row(i).tail(kDimension);
    for (double& value : normal) value = std::round(100 * random.normal());
    polyhedron.b[i] = 100 - 3 * normal.sum();
  }
  polyhedron.lo.tail(kDimension).setConstant(-kInf);
  const Lcp large = family_problem("spd", 1000, 1e6), larger = family_problem("spd", 2000, 1e6),
            grid = family_problem("ball", 65025, 0);
  return {{"auto", family_problem("nonsymmetric", 1000, 10)},
          {"lemke:max_pivots=1000000000", murty_problem(40)},
          {"lemke:max_pivots=1000000000", larger},  // of 1000 rows it is done within the limit
          {"path", larger},
          {"path", grid},
          {"pgs:max_sweeps=1000000000", blocks},
          {"psor:max_sweeps=1000000000", grid},
          {"sgs:max_sweeps=1000000000", blocks},
          {"jacobi:max_iterations=1000000000", blocks},
          {"nncg:max_sweeps=1000000000", grid},
          {"apgd", grid},
          {"mprgp", grid},
          {"multigrid:max_cycles=1000000000", family_problem("beam", 65536, 0)},  // no M-matrix
          {"admm", grid},
          {"dantzig", large},
          {"murty:max_pivots=1000000000", murty_problem(40, true)},
          {"block-pivot", grid},
          {"newton-min", grid},
          {"newton-fb", grid},
          {"interior-point", grid},
          {"ipopt", family_problem("spd", 700, 1e6)},
          {"nlopt:max_evaluations=1000000000", large},
          {"lemke-howson", family_problem("bimatrix", 1000, 0)},
          {"enumerate", Lcp::standard(DenseMatrix(skew), Vector(Eigen::VectorXd::Constant(20, -1)))},
          {"prox:max_outer=1000000", Lcp::standard(DenseMatrix(skew), Vector(Eigen::VectorXd::Constant(20, -1)))},
          {"newton-ac:max_steps=1000000", Lcp::standard(DenseMatrix(skew), Vector(Eigen::VectorXd::Constant(20, -1)))},
          {"enumerate", polyhedron}};
}

/// Dense problems in which a solver meets its first O(n³) before its first iteration.
struct Heavy {
  const char* name;
  Lcp problem;
};
std::vector<Heavy> heavy_work(Index n) {
  Random random(1);
  Eigen::MatrixXd full(n, n), growth = Eigen::MatrixXd::Identity(n, n);
  for (double& value : full.reshaped()) value = random.normal();
  const Eigen::MatrixXd half = full.leftCols(n / 2) * full.leftCols(n / 2).transpose();
  full.diagonal().array() += std::sqrt(static_cast<double>(n));
  growth.triangularView<Eigen::StrictlyLower>().setConstant(-1);
  growth.col(n - 1).setOnes();
  Vector b, lo, hi;
  b.resize(n), lo.resize(n), hi.resize(n);
  for (double& value : b) value = random.normal();
  lo.setConstant(-kInf), hi.setConstant(kInf);
  const auto problem = [&](const Eigen::MatrixXd& A) {
    Lcp p;
    p.A = DenseMatrix(A), p.b = b, p.lo = lo, p.hi = hi;
    return p;
  };
  std::vector<Heavy> result = {{"free rows, nonsymmetric", problem(full)},  // eliminated one after the other
                               {"free rows, growth", problem(growth)}};     // of its entries: pivoted completely
  for (Index i = 0; i < n; i += 2) lo[i] = 0;
  result.push_back({"half free, singular", problem(0.5 * (half + half.transpose()))});  // a second try to each first
  return result;
}

}  // namespace

TEST_CASE("every solver ends within a second of its time limit, and of a raised flag") {
  const double kGrace = kSanitized ? 30 : 3;  // [s]: one factorization of these; below 1 but on a slow, busy machine
  std::vector<std::string> seen;
  for (const auto& [spec, problem] : long_work()) {
    INFO(std::string(spec), ", ", problem.size(), " rows");
    seen.emplace_back(Spec::parse(spec).name);
    const auto solver = make_solver(spec);
    if (!solver->why_not(problem).empty()) {
      MESSAGE(std::string(spec), ": ", solver->why_not(problem));
      CHECK(solver->why_not(problem).find("built without") != std::string::npos);  // a back-end that is absent
      continue;
    }
    Solution s;
    constexpr double kLimit = 0.05;
    const double by_limit = limited(*solver, problem, kLimit, s);
    CHECK(by_limit < kLimit + kGrace);
    CHECK(s.status == Status::time_limit);

    std::atomic<bool> flag{false};
    const double by_flag = cancelled(*solver, problem, kLimit, s, flag);
    CHECK(by_flag < kLimit + kGrace);
    CHECK(s.status == Status::cancelled);
    MESSAGE(std::string(spec), ": ", by_limit, " s, ", by_flag, " s");
    CHECK(solver->solve(problem, s).status == Status::cancelled);  // raised beforehand
    solver->set_cancel(nullptr);
  }
  for (const SolverEntry& entry : solvers()) CHECK(std::ranges::count(seen, entry.name) >= 1);
}

TEST_CASE("several solves share the time of an outer budget") {
  Solution s;
  for (Long& work : long_work()) {
    CAPTURE(work.spec);
    const auto solver = make_solver(work.spec);
    Budget whole;
    whole.start(0.3, nullptr);
    solver->set_outer_budget(&whole);
    solver->set_time_limit(60);
    const double seconds = seconds_of([&] {
      for (int k = 0; k < 4; ++k) solver->solve(work.problem, s);  // 0.3 s each, if they had it
    });
    CHECK(seconds < (kSanitized ? 3 : 1));
    CHECK(s.status == Status::time_limit);
  }
}

TEST_CASE("a sparse factorization that would pass the time limit is not begun") {
  const Lcp problem = family_problem("sparse", kSanitized ? 3000 : 20000, 0);  // minutes a factorization, with KLU
  constexpr double kLimit = 0.3;
  for (const char* spec : {"path", "lemke", "block-pivot", "newton-min", "newton-fb", "interior-point", "admm"}) {
    const auto solver = make_solver(spec);
    INFO(spec);
    Solution s;
    const double seconds = limited(*solver, problem, kLimit, s);
    CHECK(seconds < kLimit + (kSanitized ? 10 : 1.5));
    CHECK((s.status == Status::time_limit || has_answer(s.status)));
    MESSAGE(std::string(spec), ": ", seconds, " s, ", name(s.status));
  }
}

TEST_CASE("predicted cost of a factorization: exact for a tridiagonal matrix, 0 without entries") {
  CHECK(factorization_cost(0, nullptr, nullptr) == 0);
  const int empty[] = {0, 0, 0};
  CHECK(factorization_cost(2, empty, nullptr) == 0);
  const RowSparse A = std::get<RowSparse>(family_problem("string", 63, 0).A);
  CHECK(factorization_cost(63, A.start.data(), A.column.data()) == 62 * 3);  // a division, a product, a difference
}

TEST_CASE("past the time limit, or a raised flag, no solver does more than about one factorization") {
  const Index n = kSanitized ? 200 : 1500;
  for (const auto& [name, problem] : heavy_work(n)) {
    const double factorization =  // [s]
        seconds_of([&] { const Eigen::PartialPivLU<Eigen::MatrixXd> lu(std::get<DenseMatrix>(problem.A)); });
    const double grace = 0.1 + 3 * factorization;  // [s]; unasked: 5 to 140 of these
    constexpr double kLimit = 0.05;
    for (const SolverEntry& entry : solvers()) {
      if (entry.name == "ipopt") continue;  // is asked once an iteration, whose factorization is twice as large
      const auto solver = entry.make("");
      if (!solver->why_not(problem).empty()) continue;
      INFO(std::string(entry.name), ", ", std::string(name), ", one factorization: ", factorization, " s");
      Solution s;
      CHECK(limited(*solver, problem, kLimit, s) < kLimit + grace);
      std::atomic<bool> flag{false};
      CHECK(cancelled(*solver, problem, kLimit, s, flag) < kLimit + grace);
    }
  }
}
