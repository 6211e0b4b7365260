// orthant replay — one problem, such as that of a failed step, by every solver: who solves it, how well, how fast?
#include "experiments/cli/commands.h"
#include "experiments/cli/problem_arguments.h"

#include "experiments/support/status_line.h"

#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <chrono>
#include <iomanip>
#include <iostream>

namespace orthant {
namespace {

struct ReplayArguments {
  ProblemArguments problem;
  std::vector<std::string> solvers;
  double time_limit = 10;
  bool json = false;
};

int run_replay(const ReplayArguments& a) {
  const Lcp problem = read_problem(a.problem);
  std::vector<std::string> specs = a.solvers;
  if (specs.empty())
    for (const SolverEntry& entry : solvers()) specs.emplace_back(entry.name);

  auto table = nlohmann::ordered_json::array();
  bool solved = false, infeasible = false;
  for (const std::string& spec : specs) {
    const auto solver = make_solver(spec);
    solver->set_time_limit(a.time_limit);
    Solution s;
    const auto begin = std::chrono::steady_clock::now();
    with_elapsed_line("replay, " + spec, [&] { solver->solve(problem, s); });
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    solved = solved || s.status == Status::solved, infeasible = infeasible || s.status == Status::infeasible;
    table.push_back({{"solver", spec},
                     {"status", name(s.status)},
                     {"residual", s.residual},
                     {"iterations", s.iterations},
                     {"seconds", seconds},
                     {"why_not", s.status == Status::unsupported ? solver->refusal(problem) : ""}});
  }
  if (a.json) {
    std::cout << table.dump(2) << '\n';
  } else {
    std::cout << a.problem.label() << ": " << problem.size() << " rows, " << problem.friction.size()
              << " of them friction\n"
              << std::left << std::setw(20) << "solver" << std::setw(17) << "status" << std::setw(12) << "residual"
              << std::setw(12) << "iterations"
              << "seconds\n";
    for (const auto& row : table) {
      std::cout << std::setw(20) << row["solver"].get<std::string>() << std::setw(17)
                << row["status"].get<std::string>();
      if (const auto why = row["why_not"].get<std::string>(); !why.empty())
        std::cout << why << '\n';
      else
        std::cout << std::setw(12) << std::setprecision(3) << row["residual"].get<double>() << std::setw(12)
                  << row["iterations"].get<int>() << row["seconds"].get<double>() << '\n';
    }
  }
  return exit_code_of(solved ? Status::solved : infeasible ? Status::infeasible : Status::stalled);
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand("replay", "One problem, such as a failed step's, by every solver");
  add_problem_options(*command, arguments->problem);
  command->add_option("--solver", arguments->solvers, "NAME[:option=value,...], may be repeated; default: all");
  add_time_limit(*command, arguments->time_limit, "of each solver [s]")->capture_default_str();
  command->add_flag("--json", arguments->json, "the table as JSON");
  command->footer(
      "Exit codes: 0 one solved it, 1 bad input, 2 one proved it infeasible, 3 none did either.\n"
      "Examples:\n"
      "  orthant replay failed_step_17.json\n"
      "  orthant replay failed_step_17.json --solver lemke --solver pgs:omega=1.3 --json");
  command->callback([arguments, &exit_code] { exit_code = run_replay(*arguments); });
}

}  // namespace orthant
