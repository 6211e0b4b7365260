// experiments/cli/problem_arguments.h — problem arguments of commands: a file, or Matrix Market files of its parts.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <CLI/CLI.hpp>

#include <string>

namespace orthant {

struct ProblemArguments {
  std::string problem, matrix, vector, lower, upper;

  std::string label() const { return problem.empty() ? matrix : problem; }
};

/// The positional `problem`, --matrix, --vector, --lower, --upper. `arguments` must outlive the parse.
void add_problem_options(CLI::App& command, ProblemArguments& arguments);

/// Throws std::invalid_argument naming file, entry and rule.
Lcp read_problem(const ProblemArguments& arguments);

/// The matrix alone: q and bounds are not needed, nor read.
Matrix read_matrix(const ProblemArguments& arguments);

}  // namespace orthant
