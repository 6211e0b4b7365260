#include "experiments/cli/problem_arguments.h"

#include "experiments/runs/problem_file.h"

#include <orthant/core/lcp/files/io.h>

#include <cmath>

namespace orthant {
namespace {

bool is_matrix_market(const std::string& file) { return file.ends_with(".mtx"); }

void check_one_way(const ProblemArguments& a) {
  if (!a.problem.empty() && (!a.matrix.empty() || !a.vector.empty() || !a.lower.empty() || !a.upper.empty()))
    throw std::invalid_argument("either a problem file or --matrix and --vector, not both");
}

}  // namespace

void add_problem_options(CLI::App& command, ProblemArguments& a) {
  command.add_option("problem", a.problem, "JSON problem file or FCLIB file (.hdf5, .h5)");
  command.add_option("--matrix", a.matrix, "M, Matrix Market");
  command.add_option("--vector", a.vector, "q, Matrix Market");
  command.add_option("--lower", a.lower, "lower bounds, Matrix Market; default 0");
  command.add_option("--upper", a.upper, "upper bounds, Matrix Market; default infinity");
}

Lcp read_problem(const ProblemArguments& a) {
  check_one_way(a);
  if (is_matrix_market(a.problem))
    throw std::invalid_argument(a.problem + ": a matrix alone is no problem: needs --matrix " + a.problem +
                                " --vector FILE");
  if (!a.problem.empty()) return read_problem_file(a.problem);
  if (a.matrix.empty() || a.vector.empty())
    throw std::invalid_argument("needs a problem file, or --matrix and --vector");
  Lcp problem = Lcp::standard(read_matrix_market(a.matrix), read_matrix_market_vector(a.vector));
  const auto same_size = [&](const std::string& file, Index size) {
    if (size != order(problem.A))
      throw std::invalid_argument(file + ": has " + std::to_string(size) + " entries: must have " +
                                  std::to_string(order(problem.A)) + ", as " + a.matrix + " has rows");
  };
  same_size(a.vector, problem.size());
  for (Index i = 0; i < problem.size(); ++i)
    if (!std::isfinite(problem.b[i]))
      throw std::invalid_argument(a.vector + ": entry " + std::to_string(i + 1) + " must be finite");
  if (!a.lower.empty()) problem.lo = read_matrix_market_vector(a.lower), same_size(a.lower, problem.lo.size());
  if (!a.upper.empty()) problem.hi = read_matrix_market_vector(a.upper), same_size(a.upper, problem.hi.size());
  check(problem);
  return problem;
}

Matrix read_matrix(const ProblemArguments& a) {
  check_one_way(a);
  if (is_matrix_market(a.problem)) return read_matrix_market(a.problem);
  if (!a.problem.empty()) return read_problem_file(a.problem).A;
  if (a.matrix.empty()) throw std::invalid_argument("needs a problem file or a matrix");
  return read_matrix_market(a.matrix);
}

}  // namespace orthant
