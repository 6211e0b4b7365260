// orthant enumerate — every solution of a small problem, exactly.
#include "experiments/cli/commands.h"
#include "experiments/cli/problem_arguments.h"

#include "experiments/support/status_line.h"

#include <orthant/solvers/pivoting/enumerate.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <iostream>

namespace orthant {
namespace {

/// What is beyond the doubles as the text that problem files have for it: JSON's numbers end there.
nlohmann::ordered_json number(double x) {
  if (std::isfinite(x)) return x;
  return x > 0 ? "inf" : "-inf";
}

nlohmann::ordered_json lists(const std::vector<Vector>& vectors) {
  auto all = nlohmann::ordered_json::array();
  for (const Vector& x : vectors) {
    auto& list = all.emplace_back(nlohmann::ordered_json::array());
    for (const double entry : x) list.push_back(number(entry));
  }
  return all;
}

struct EnumerateArguments {
  ProblemArguments problem;
  std::optional<double> time_limit;
  bool json = false;
};

int run_enumerate(const EnumerateArguments& a) {
  Budget budget;
  const Lcp problem = read_problem(a.problem);
  budget.start(a.time_limit.value_or(kInf), nullptr);
  const SolutionSet set =
      with_elapsed_line("enumerate", [&] { return enumerate_solutions(problem, [&] { return budget.exhausted(); }); });
  nlohmann::ordered_json json = {{"isolated", lists(set.isolated)}, {"faces", nlohmann::ordered_json::array()}};
  for (const SolutionFace& f : set.faces)
    json["faces"].push_back({{"dimension", f.dimension},
                             {"vertices", lists(f.vertices)},
                             {"directions", lists(f.directions)},
                             {"lines", lists(f.lines)}});
  json["complete"] = set.complete;
  if (a.json) {
    std::cout << json.dump(2) << '\n';
  } else {
    std::cout << set.isolated.size() << " isolated, " << set.faces.size() << " faces of solutions\n";
    for (const auto& z : json["isolated"]) std::cout << "z = " << z << '\n';
    for (const auto& face : json["faces"]) std::cout << "face = " << face << '\n';
  }
  if (!set.complete) {
    std::cerr << "orthant: the time was over: there may be more\n";
    return exit_code_of(Status::time_limit);
  }
  return set.isolated.empty() && set.faces.empty() ? exit_code_of(Status::infeasible) : 0;
}

}  // namespace

void add_enumerate(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<EnumerateArguments>();
  CLI::App* command =
      app.add_subcommand("enumerate", "All solutions of a small problem (at most 2^20 cells: 2 a row, 3 a box)");
  add_problem_options(*command, arguments->problem);
  add_time_limit(*command, arguments->time_limit, "[s]; solutions found by then are reported");
  command->add_flag("--json", arguments->json, "answer as one JSON object");
  command->footer(
      "Exit codes: 0 there are solutions, 1 bad input or too large, 2 there is none, 3 not all was searched in time.\n"
      "Examples:\n"
      "  orthant enumerate --matrix M.mtx --vector q.mtx\n"
      "  orthant enumerate mine.json --json");
  command->callback([arguments, &exit_code] { exit_code = run_enumerate(*arguments); });
}

}  // namespace orthant
