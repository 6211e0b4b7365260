// Which solver is fast, and how good is what it calls solved?
//
// Every solver of the registry, and whatever rivals there are (experiments/benchmarks), on problem families, known
// problems, steps of simulations, and files. Writes a row per case (what there is, every minute), a summary per solver,
// a table of what really answered, the time of auto over the fastest solver's, a manifest. Times are processor time.
#include "experiments/runs/manifest.h"
#include "experiments/studies/support/solver_table.h"
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/plugin.h"

#include <orthant/core/support/file.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <iomanip>
#include <iostream>

using namespace orthant;

namespace {

struct Plan {
  std::filesystem::path output = "results/lcp_shootout";
  LcpCaseChoice choice;
  std::vector<std::string> solvers;
  std::filesystem::path rivals;  // a folder
  TrialLimits limits;
  bool quick = false;
};

void run(Plan plan, const std::string& command_line) {
  if (plan.solvers.empty())
    for (const SolverEntry& entry : solvers()) plan.solvers.emplace_back(entry.name);
  for (const std::string& spec : plan.solvers) make_solver(spec);  // unknown: said at once
  const auto others = plan.rivals.empty() ? std::vector<Rival>() : rivals(plan.rivals);
  const auto cases = lcp_cases(plan.choice);
  std::filesystem::create_directories(plan.output);
  check_writable(plan.output / "shootout.csv");
  const auto save = [&](const SolverTable& table) { write_whole(plan.output / "shootout.csv", table.csv()); };
  const SolverTable table = try_all(plan.solvers, others, cases, plan.limits, save);
  save(table);
  const SolverTable::Cells summary = table.summary();
  write_whole(plan.output / "summary.csv", to_csv(summary));
  write_whole(plan.output / "paths.csv", table.paths_csv());
  if (std::ranges::count(table.solvers, "auto") > 0)
    write_whole(plan.output / "regret.csv", to_csv(table.regret("auto")));
  auto about = manifest();
  about["command"] = command_line;
  about["options"] = {{"solvers", table.solvers},     {"families", plan.choice.families},
                      {"scenes", plan.choice.scenes}, {"problems", plan.choice.problems},
                      {"rivals", plan.rivals},        {"largest", plan.choice.largest},
                      {"seeds", plan.choice.seeds},   {"time_limit", plan.limits.time},
                      {"memory", plan.limits.memory}, {"jobs", plan.limits.jobs},
                      {"quick", plan.quick}};
  write_whole(plan.output / "manifest.json", about.dump(2) + "\n");
  for (const auto& line : summary) {
    std::cout << std::left << std::setw(16) << line[0] << std::right;
    for (std::size_t i = 1; i < line.size(); ++i)
      std::cout << std::setw(static_cast<int>(summary[0][i].size()) + 2) << line[i];
    std::cout << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  CLI::App app("Every solver on families of problems: speed against achieved residual, claims checked");
  app.add_option("--output", plan.output, "folder for tables and manifest")->capture_default_str();
  app.add_option_function<std::string>("--plugin", load_plugin, "shared library that registers solvers of its own");
  app.add_option("--solvers", plan.solvers, "NAME[:option=value,...] ...; default: all of the registry");
  app.add_option("--rivals", plan.rivals, "folder of rivals' drivers; they take part as well");
  app.add_option("--families", plan.choice.families,
                 "names of core/lcp/problems/families.h, known, steps; default: all");
  app.add_option("--scenes", plan.choice.scenes, "scenes whose steps are recorded")->capture_default_str();
  app.add_option("--problems", plan.choice.problems,
                 "files: .json, .hdf5 (FCLIB), M.mtx+q.mtx, or M.mtx next to M_q.mtx");
  const auto* largest = app.add_option("--largest", plan.choice.largest, "no families' problems larger than this")
                            ->check(CLI::Range(1, 1 << 30));
  app.add_option("--seeds", plan.choice.seeds, "of random families")->check(CLI::Range(1, 1000))->capture_default_str();
  const auto* limit = app.add_option("--time-limit", plan.limits.time, "of a solve [s]; killed after 1.5 times that")
                          ->check(between(1e-6, 1e6))
                          ->capture_default_str();
  app.add_option("--memory", plan.limits.memory, "of a solve [GB], 0: no limit")->check(between(0.0, 1e6));
  app.add_option("--jobs", plan.limits.jobs, "processes at a time; more than 1 disturb each other's times")
      ->check(CLI::Range(1U, 1024U))
      ->capture_default_str();
  app.add_flag("--quick", plan.quick, "smallest sizes, 0.3 s a solve");
  if (const auto end = parse(app, argc, argv)) return *end;
  plan.choice.smallest_only = plan.quick && largest->count() == 0;
  if (plan.quick && limit->count() == 0) plan.limits.time = 0.3;
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  try {
    run(plan, command_line);
  } catch (const std::exception& error) {
    std::cerr << "lcp_shootout: " << error.what() << '\n';
    return 1;
  }
}
