// orthant analyse — class of a problem's matrix, so that a method can be chosen.
#include "experiments/cli/commands.h"
#include "experiments/cli/problem_arguments.h"

#include "experiments/support/status_line.h"

#include <orthant/core/lcp/judge/analyse.h>
#include <orthant/solvers/budget.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <iomanip>
#include <iostream>

namespace orthant {
namespace {

struct AnalyseArguments {
  ProblemArguments problem;
  std::optional<double> time_limit;
  bool json = false;
};

int run_analyse(const AnalyseArguments& arguments) {
  Budget budget;
  const Matrix A = read_matrix(arguments.problem);
  const double limit = arguments.time_limit.value_or(kInf);
  budget.start(limit, nullptr);
  const auto stop = [&] { return budget.exhausted(); };
  const Analysis a = with_elapsed_line("analyse", [&] { return analyse(A, stop, limit); });

  nlohmann::ordered_json rank = a.rank;
  if (a.rank < 0) rank = name(Verdict::not_decided);
  nlohmann::ordered_json json = {{"n", a.n},
                                 {"symmetric", name(a.symmetric)},
                                 {"positive definite", name(a.positive_definite)},
                                 {"positive semidefinite", name(a.positive_semidefinite)},
                                 {"diagonally dominant", name(a.diagonally_dominant)},
                                 {"Z", name(a.z)},
                                 {"K", name(a.k)},
                                 {"H+", name(a.h_plus)},
                                 {"P", name(a.p)},
                                 {"P0", name(a.p0)},
                                 {"copositive", name(a.copositive)},
                                 {"column sufficient", name(a.column_sufficient)},
                                 {"row sufficient", name(a.row_sufficient)},
                                 {"rank", rank},
                                 {"smallest entry", a.smallest},
                                 {"largest entry", a.largest},
                                 {"condition", a.condition}};
  if (!a.not_p.empty()) json["minor not positive"] = a.not_p;  // rows, counted from 0
  if (!std::isfinite(a.condition))
    json["condition"] = std::isnan(a.condition) ? name(Verdict::not_decided) : "infinite";
  if (arguments.json) {
    std::cout << json.dump(2) << '\n';
    return 0;
  }
  for (const auto& [key, value] : json.items())
    std::cout << std::left << std::setw(24) << key << (value.is_string() ? value.get<std::string>() : value.dump())
              << '\n';
  return 0;
}

}  // namespace

void add_analyse(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<AnalyseArguments>();
  CLI::App* command = app.add_subcommand("analyse", "What kind of matrix: definite, P, K, copositive, rank, condition");
  command->add_option("problem", arguments->problem.problem, "JSON problem file, FCLIB file, or a matrix (.mtx)");
  command->add_option("--matrix", arguments->problem.matrix, "M, Matrix Market");
  add_time_limit(*command, arguments->time_limit, "[s]; properties still open are reported as not decided");
  command->add_flag("--json", arguments->json, "answer as one JSON object; rows count from 0");
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Examples:\n"
      "  orthant analyse M.mtx\n"
      "  orthant analyse mine.json --json");
  command->callback([arguments, &exit_code] { exit_code = run_analyse(*arguments); });
}

}  // namespace orthant
