// Solvers that minimize and polish: ipopt and nlopt, in builds that have them; what the others answer.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/support/backends.h"
#include "tests/support/judge.h"

using namespace orthant;

namespace {

Lcp scalar() { return Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(1, 1)), Vector{-1}); }

/// Those of the two that this build has.
std::vector<std::string> present() {
  std::vector<std::string> names;
  for (const char* name : {"ipopt", "nlopt"})
    if (built(name)) names.emplace_back(name);
  return names;
}

/// The string over an obstacle, u″ ≤ 8, on n inner nodes of (0, 1), u + gap = z: exact for gap = 1/4.
Lcp string_problem(int n, double gap) {
  const double h = 1.0 / (n + 1);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2 / (h * h));
    if (i > 0) entries.emplace_back(i, i - 1, -1 / (h * h)), entries.emplace_back(i - 1, i, -1 / (h * h));
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  Vector q(Eigen::VectorXd::Constant(n, 8));
  q[0] -= gap / (h * h), q[n - 1] -= gap / (h * h);
  return Lcp::standard(RowSparse::from(A), q);
}

}  // namespace

TEST_CASE("a build without a back-end still lists its solver, and why_not names the package") {
  for (const auto& [name, package] : {std::pair{"ipopt", "coinor-libipopt-dev"}, {"nlopt", "libnlopt-dev"}}) {
    const auto solver = make_solver(name);
    Solution s;
    const Status status = solver->solve(scalar(), s).status;
    const std::string reason = solver->why_not(scalar());
    CHECK(status == (reason.empty() ? Status::solved : Status::unsupported));
    if (!reason.empty()) CHECK(reason.find(package) != std::string::npos);
  }
}

TEST_CASE("string over an obstacle, sparse: minimizers end on the exact solution; a warm start costs nothing") {
  for (const std::string& name : present())
    for (const int n : {15, 63, 255}) {
      INFO(name, ", n = ", n);
      const auto solver = make_solver(name);
      Solution s;
      CHECK(solver->solve(string_problem(n, 0.25), s).status == Status::solved);
      double error = 0;
      for (int i = 0; i < n; ++i) {
        const double x = std::min(i + 1, n - i) / (n + 1.0);
        error = std::max(error, std::abs(s.z[i] - (x < 0.25 ? 4 * (x - 0.25) * (x - 0.25) : 0)));
      }
      CHECK(error <= 1e-13 * n);
      CHECK(s.iterations > 1);
      CHECK(solver->solve(string_problem(n, 0.25), s, Start::warm).status == Status::solved);
      CHECK(s.iterations == 0);
    }
}

TEST_CASE("monotone problems, degenerate and rank deficient, boxes and free rows: minimizers solve all, to rounding") {
  for (const std::string& name : present()) {
    Random random(41);
    const auto solver = make_solver(name);
    for (int trial = 0; trial < 60; ++trial) {
      const int n = random.integer(1, 12);
      Known k = planted_problem(n, random.integer(0, n), random.integer(0, n), random);
      Lcp& p = k.problem;
      for (Index i = 0; i < n && trial % 2 == 1; ++i) {  // the planted solution stays one
        if (random.integer(0, 2) == 0) p.hi[i] = k.z[i] + random.integer(0, 2);
        if (random.integer(0, 3) == 0 && k.z[i] > 0) p.lo[i] = -kInf;
      }
      Solution s;
      solver->solve(p, s);
      INFO(name, ", trial ", trial, ", n = ", n, ": ", orthant::name(s.status), ", residual ", s.residual);
      CHECK(s.status == Status::solved);
      CHECK(independent_residual(p, s.z) < 1e-13);
    }
  }
}

TEST_CASE("convex quadratic programs: both forms agree with Lemke's method") {
  for (const std::string& name : present()) {
    Random random(42);
    for (int trial = 0; trial < 20; ++trial) {
      Lcp p = random_spd_problem(random.integer(1, 20), random);
      for (Index i = 0; i < p.size(); i += 2) p.hi[i] = random.uniform(0.0, 1.0);
      Solution expected, s;
      REQUIRE(make_solver("lemke")->solve(p, expected).status == Status::solved);
      for (const char* form : {":form=quadratic", ":form=merit"}) {
        INFO(name, std::string(form), ", trial ", trial);
        CHECK(make_solver(name + form)->solve(p, s).status == Status::solved);
        CHECK((s.w - expected.w).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + p.b.lpNorm<Eigen::Infinity>()));
      }
    }
  }
}

TEST_CASE("every algorithm of NLopt solves the collection's small problems, or is honest") {
  if (!built("nlopt")) return;
  for (const std::string algorithm : {"var1", "var2", "tnewton", "ccsa", "mma", "slsqp"}) {
    const auto solver = make_solver("nlopt:max_evaluations=2000,algorithm=" + algorithm);
    for (const Known& k : known_problems()) {
      if (k.problem.size() > 12) continue;
      INFO(algorithm, " on ", k.name);
      Solution s;
      solver->solve(k.problem, s);
      if (k.answer == Answer::none)
        CHECK(s.status == Status::stalled);
      else
        CHECK(s.status == (k.answer == Answer::infeasible ? Status::infeasible : Status::solved));
    }
  }
}

TEST_CASE("ipopt keeps its structure: problems of one pattern, then of another, are solved as by a fresh solver") {
  if (!built("ipopt")) return;
  Random random(43);
  const auto kept = make_solver("ipopt:polish=false,tolerance=1e-6");
  for (int trial = 0; trial < 12; ++trial) {
    Lcp p = random_spd_problem(trial < 8 ? 6 : 7, random);
    if (trial % 4 == 3) std::get<DenseMatrix>(p.A)(0, 1) += 0.5;  // not symmetric: the other program
    if (trial >= 4) p.hi[trial % 3] = 0.1;
    if (trial == 10) p.hi = p.lo;
    Solution s, fresh;
    INFO("trial ", trial);
    CHECK(kept->solve(p, s).status == Status::solved);
    CHECK(make_solver("ipopt:polish=false,tolerance=1e-6")->solve(p, fresh).status == Status::solved);
    CHECK((s.z - fresh.z).lpNorm<Eigen::Infinity>() <= 1e-6);
    CHECK(s.iterations == fresh.iterations);
    if (trial == 10) continue;  // all rows fixed: nothing to iterate
    CHECK(kept->solve(p, s, Start::warm).status == Status::solved);
    CHECK(s.iterations < fresh.iterations);  // a warm start, without the polish
  }
}

TEST_CASE("ipopt prints nothing and reads no options file") {
  if (!built("ipopt")) return;
  namespace fs = std::filesystem;
  const fs::path home = fs::current_path(),
                 dir = fs::temp_directory_path() / ("orthant_ipopt_" + std::to_string(getpid()));
  fs::create_directory(dir);
  fs::current_path(dir);
  std::ofstream("ipopt.opt") << "output_file ipopt.out\n";
  std::fflush(stdout);
  const int screen = dup(1);
  std::FILE* const file = std::fopen("out", "w");
  dup2(fileno(file), 1);
  Solution s;
  for (const Known& k : known_problems())
    if (k.name == "qp" || k.name == "infeasible_psd" || k.name == "bimatrix") make_solver("ipopt")->solve(k.problem, s);
  std::fflush(stdout);
  dup2(screen, 1);
  close(screen);
  std::fclose(file);
  CHECK(fs::file_size("out") == 0);
  CHECK_FALSE(fs::exists("ipopt.out"));
  CHECK(s.status == Status::solved);
  CHECK(s.iterations > 0);
  fs::current_path(home);
  fs::remove_all(dir);
}

TEST_CASE("forms and algorithms say what they cannot take") {
  const Lcp skew = Lcp::standard(DenseMatrix(Eigen::MatrixXd{{1, 2}, {0, 1}}), Vector{-1, -1});
  for (const std::string& name : present()) {
    CHECK(make_solver(name + ":form=quadratic")->why_not(skew).find("symmetric") != std::string::npos);
    CHECK(make_solver(name)->why_not(skew).empty());
    Random random(44);
    CHECK(make_solver(name + ":form=quadratic")->why_not(random_contact_problem(1, 2, 0.5, random)).find("friction") !=
          std::string::npos);
    if (name == "nlopt")
      CHECK(make_solver("nlopt:algorithm=slsqp")->why_not(string_problem(1001, 0.25)).find("1000") !=
            std::string::npos);
  }
}

TEST_CASE("minimizers end at a time limit and when cancelled, whatever the algorithm") {
  Random random(45);
  const Lcp p = planted_problem(120, 60, 60, random).problem;
  std::vector<std::string> specs;
  for (const std::string& name : present()) {
    if (name == "ipopt") specs.push_back("ipopt:max_iterations=1000000");
    for (const char* algorithm : {"lbfgs", "var2", "tnewton", "ccsa", "mma", "slsqp"})
      if (name == "nlopt") specs.push_back(std::string("nlopt:max_evaluations=1000000000,algorithm=") + algorithm);
  }
  for (const std::string& spec : specs) {
    INFO(spec);
    const auto solver = make_solver(spec);
    Solution s;
    solver->set_time_limit(0.02);
    const auto begin = std::chrono::steady_clock::now();
    CHECK(solver->solve(p, s).status == Status::time_limit);
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(1));
    CHECK(s.z.allFinite());
    solver->set_time_limit(kInf);
    const std::atomic<bool> cancel{true};
    solver->set_cancel(&cancel);
    CHECK(solver->solve(p, s).status == Status::cancelled);
  }
}

TEST_CASE("contacts with friction: a minimizer's claims are right, and most problems are solved") {
  for (const std::string& name : present()) {
    Random random(46);
    const auto solver = make_solver(name + ":restarts=0");
    int solved = 0;
    for (int trial = 0; trial < 30; ++trial) {
      const Lcp p = random_contact_problem(random.integer(1, 5), 12, 0.5, random);
      Solution s;
      if (solver->solve(p, s).status != Status::solved) continue;
      ++solved;
      CHECK(independent_residual(p, s.z) < 1e-12);
    }
    MESSAGE(name, " solves ", solved, " of 30");
    CHECK(solved >= 25);
  }
}
