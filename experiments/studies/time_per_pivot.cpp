// What does a pivot cost, relative to the least possible cost: one rank-1 update of an n × n matrix?
//
// Pivoting methods on random positive definite problems, dense: time of a solve over its pivots, so with the share of
// loading, refining and judging; the best of several repeats, processor time. Printed as a Markdown table, µs and
// multiples.
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/reference_kernel.h"

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <iomanip>
#include <iostream>

using namespace orthant;

namespace {

/// The least time of work() [s] over at least 3 calls and `seconds` in all.
template <class Work> double best(double seconds, const Work& work) {
  double least = kInf, total = 0;
  for (int k = 0; k < 3 || total < seconds; ++k) {
    const double begin = thread_time();
    work();
    const double spent = thread_time() - begin;
    least = std::min(least, spent), total += spent;
  }
  return least;
}

double rank_one(Index n, double seconds) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Ones(n, n);
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(n, 1e-9), v = Eigen::VectorXd::Constant(n, 1.0);
  const int calls = static_cast<int>(1 + 1000000 / (n * n));  // beyond the clock's resolution
  const double spent = best(seconds, [&] {
    for (int k = 0; k < calls; ++k) A.noalias() += u * v.transpose();
  });
  return A.allFinite() ? spent / calls : kInf;  // looked at: else nothing need be computed
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Time per pivot of the pivoting methods, relative to one rank-1 update of the same size");
  std::vector<Index> sizes{8, 16, 64, 256, 1024};
  std::vector<std::string> specs{"lemke:form=tableau", "lemke:form=revised", "murty:max_pivots=2000",
                                 "dantzig:max_pivots=2000", "path:max_crash=0"};
  double seconds = 0.3;
  app.add_option("--sizes", sizes, "rows n")->check(CLI::Range(1, 5000))->capture_default_str();
  app.add_option("--solvers", specs, "as in orthant list, with options")->capture_default_str();
  app.add_option("--seconds", seconds, "of repeats for each number, at least 3")
      ->check(between(0, 1e4))
      ->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  for (const std::string& spec : specs) make_solver(spec);  // an unknown one is refused before the table

  std::cout << "| n | rank-1 update, µs | solver | pivots | µs a pivot | rank-1 updates a pivot "
               "|\n|---|---|---|---|---|---|\n"
            << std::fixed;
  for (const Index n : sizes) {
    const double update = rank_one(n, seconds);
    Random random(1);
    const Lcp problem = random_spd_problem(n, random);
    for (const std::string& spec : specs) {
      const auto solver = make_solver(spec);
      Solution s;
      const double pivot = best(seconds, [&] { solver->solve(problem, s); }) / std::max(1, s.iterations);
      std::cout << "| " << n << " | " << std::setprecision(3) << 1e6 * update << " | `" << spec << "` | "
                << s.iterations << " | " << 1e6 * pivot << " | " << std::setprecision(1) << pivot / update << " |"
                << std::endl;
    }
  }
} catch (const std::exception& error) {  // an unknown solver or option
  std::cerr << "time_per_pivot: " << error.what() << '\n';
  return 1;
}
