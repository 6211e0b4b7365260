// Which solver is fast, and how good is what it calls solved?
//
// Every solver of the registry, and whatever rivals there are (experiments/benchmarks), on problem families, known
// problems, steps of simulations, and files. Each case is a
// process of its own with a time limit; the residual is recomputed by a second judge; failures are rows too. Writes a row
// per case (what there is, every minute), a summary per solver, a table of what really answered, a manifest. Times are
// processor time.
#include "experiments/support/isolated.h"
#include "experiments/support/lcp_cases.h"
#include "experiments/support/lcp_trial.h"
#include "experiments/support/manifest.h"
#include "experiments/support/progress.h"
#include "experiments/support/rivals.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <array>
#include <chrono>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>

using namespace orthant;

namespace {

struct Plan {
  std::filesystem::path output = "results/lcp_shootout";
  LcpCaseChoice choice;
  std::vector<std::string> solvers;  // rivals last
  std::filesystem::path rivals_folder;
  std::vector<Rival> rivals;
  double time_limit = 2, memory = 4;  // [s], [GB]
  unsigned jobs = 1;
  bool quick = false;
};

struct Row {
  std::size_t problem = 0, solver = 0;
  Trial trial;
  Result result = Result::skipped;
};

struct Problem {
  LcpCase about;
  std::string group;
  Index n = 0;
  double scale = 1;       // 1 + ‖b‖∞
  double best = kInf;     // fastest certified [s]
  bool solvable = false;  // somebody's solution was accepted
};

/// A solver out of time on a problem is not asked for larger ones of that family and hardness.
class OutOfTime {
 public:
  bool hopeless(const std::string& solver, const LcpCase& c) const {
    const auto entry = size_.find({solver, c.family, c.hardness});
    return entry != size_.end() && entry->second < c.size && find_family(c.family) != nullptr;
  }
  void note(const std::string& solver, const LcpCase& c, const Trial& t) {
    if (t.status != name(Status::time_limit) && t.status != "killed") return;
    auto& size = size_.try_emplace({solver, c.family, c.hardness}, c.size).first->second;
    size = std::min(size, c.size);
  }

 private:
  std::map<std::tuple<std::string, std::string, double>, Index> size_;
};

Trial trial_of(const Outcome& outcome) {
  if (outcome.kind == Outcome::finished) return trial_from_text(outcome.text);
  constexpr const char* kNames[] = {"", "exception", "crashed", "killed"};
  Trial t;
  t.status = kNames[outcome.kind];
  t.note = outcome.text;
  return t;
}

std::vector<Row> run_all(const Plan& plan, const std::vector<LcpCase>& cases, std::vector<Problem>& problems,
                         const std::function<void(const std::vector<Row>&)>& save) {
  const auto work_of = [](const LcpCase& c) { return std::sqrt(static_cast<double>(c.size)); };  // a rough guess
  double work = 0;
  for (const LcpCase& c : cases) work += work_of(c) * static_cast<double>(plan.solvers.size());
  Progress progress("shootout", work);
  std::vector<Row> rows;
  rows.reserve(cases.size() * plan.solvers.size());
  OutOfTime out_of_time;
  Isolated processes(plan.jobs, static_cast<std::size_t>(plan.memory * 0x1p30));
  auto saved = std::chrono::steady_clock::now();
  for (std::size_t p = 0; p < cases.size(); ++p) {
    if (std::chrono::steady_clock::now() - saved > std::chrono::minutes(1)) {
      save(rows);
      saved = std::chrono::steady_clock::now();
    }
    const LcpCase& c = cases[p];
    const Lcp problem = c.make();
    problems.push_back({c, group(c, problem), problem.size(), 1 + problem.b.lpNorm<Eigen::Infinity>()});
    for (std::size_t s = 0; s < plan.solvers.size(); ++s) {
      Row& row = rows.emplace_back(Row{p, s, {}, Result::skipped});
      const std::string& spec = plan.solvers[s];
      const double step = work_of(c);
      processes.wait_for_room();  // the last result may make this one hopeless
      if (out_of_time.hopeless(spec, c)) {
        row.trial.note = "out of time on a smaller one";
        progress.add(step, false);
        continue;
      }
      const auto rival = std::ranges::find(plan.rivals, spec, &Rival::name);
      const bool ours = rival == plan.rivals.end();
      processes.start(
          [&] { return to_text(ours ? try_solver(problem, spec, plan.time_limit) : try_rival(problem, *rival)); },
          1.5 * plan.time_limit + (ours ? 0.1 : 3),  // [s] the rest: to start, and to be judged
          [&row, &c, &spec, &progress, &out_of_time, step](const Outcome& outcome) {
            row.trial = trial_of(outcome);
            row.result = judge(row.trial, c.answer);
            out_of_time.note(spec, c, row.trial);
            progress.add(step, row.result == Result::wrong || row.result == Result::crashed);
          });
    }
  }
  processes.wait_for_all();
  return rows;
}

/// What only the whole table tells: who was fastest, and whether somebody solved what others call infeasible.
void compare(std::vector<Row>& rows, std::vector<Problem>& problems) {
  for (const Row& row : rows)
    problems[row.problem].solvable |= row.result == Result::certified && row.trial.status == name(Status::solved);
  for (Row& row : rows) {
    if (row.trial.status == name(Status::infeasible) && problems[row.problem].solvable) row.result = Result::wrong;
    if (row.result == Result::certified)
      problems[row.problem].best = std::min(problems[row.problem].best, row.trial.seconds);
  }
}

std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}
std::string number(double x) { return std::isfinite(x) ? detail::text_of(x) : ""; }  // not measured: empty

std::string table(const Plan& plan, const std::vector<Row>& rows, const std::vector<Problem>& problems) {
  std::string text =
      "problem,family,group,n,hardness,seed,solver,result,status,iterations,runs,seconds,residual,relative_residual,"
      "rounding,stages,note\n";
  for (const auto& [p, s, t, result] : rows) {
    const auto& [about, group, n, scale, best, solvable] = problems[p];
    text += quoted(about.name) + ',' + about.family + ',' + group + ',' + std::to_string(n) + ',' +
            number(about.hardness) + ',' + std::to_string(about.seed) + ',' + quoted(plan.solvers[s]) + ',' +
            name(result) + ',' + t.status + ',' + std::to_string(t.iterations) + ',' + std::to_string(t.runs);
    for (const double x : {t.seconds, t.residual, t.residual / scale, t.rounding}) text += ',' + number(x);
    text += ',' + quoted(t.stages) + ',' + quoted(t.note) + '\n';
  }
  return text;
}

using Summary = std::vector<std::vector<std::string>>;  // rows of cells, the first the titles

Summary summary(const Plan& plan, const std::vector<Row>& rows, const std::vector<Problem>& problems) {
  Summary table{{"solver", "problems"}};
  for (int v = 0; v < kResults; ++v) table[0].emplace_back(name(static_cast<Result>(v)));
  table[0].emplace_back("median_time_to_best");
  for (std::size_t s = 0; s < plan.solvers.size(); ++s) {
    std::array<int, kResults> count{};
    std::vector<double> ratios;
    for (const Row& row : rows) {
      if (row.solver != s) continue;
      ++count[static_cast<std::size_t>(row.result)];
      if (row.result == Result::certified) ratios.push_back(row.trial.seconds / problems[row.problem].best);
    }
    auto& line = table.emplace_back(std::vector{plan.solvers[s], std::to_string(problems.size())});
    for (const int c : count) line.push_back(std::to_string(c));
    std::ranges::sort(ratios);
    std::ostringstream ratio;
    if (!ratios.empty()) ratio << std::setprecision(3) << ratios[ratios.size() / 2];
    line.push_back(ratio.str());
  }
  return table;
}

/// What really answered, by solver and family: a method that hands a problem on, or has shortcuts, is seen here.
std::string paths(const Plan& plan, const std::vector<Row>& rows, const std::vector<Problem>& problems) {
  std::map<std::array<std::string, 3>, std::array<int, 2>> count;  // certified, others
  for (const Row& row : rows)
    if (row.result != Result::refused && row.result != Result::skipped)
      ++count[{plan.solvers[row.solver], problems[row.problem].about.family, row.trial.stages}]
             [row.result == Result::certified ? 0 : 1];
  std::string text = "solver,family,stages,certified,not_certified\n";
  for (const auto& [key, n] : count)
    text += quoted(key[0]) + ',' + key[1] + ',' + quoted(key[2]) + ',' + std::to_string(n[0]) + ',' +
            std::to_string(n[1]) + '\n';
  return text;
}

void print(const Summary& table) {
  for (const auto& line : table) {
    std::cout << std::left << std::setw(16) << line[0] << std::right;
    for (std::size_t i = 1; i < line.size(); ++i)
      std::cout << std::setw(static_cast<int>(table[0][i].size()) + 2) << line[i];
    std::cout << '\n';
  }
}

std::string csv(const Summary& table) {
  std::string text;
  for (const auto& line : table)
    for (std::size_t i = 0; i < line.size(); ++i)
      text += (&line != &table[0] && i == 0 ? quoted(line[i]) : line[i]) + (i + 1 < line.size() ? ',' : '\n');
  return text;
}

void run(const Plan& plan, const std::string& command_line) {
  std::filesystem::create_directories(plan.output);
  check_writable(plan.output / "shootout.csv");
  std::vector<Problem> problems;
  std::vector<Row> rows = run_all(plan, lcp_cases(plan.choice), problems, [&](const std::vector<Row>& so_far) {
    write_whole(plan.output / "shootout.csv", table(plan, so_far, problems));
  });
  compare(rows, problems);
  const Summary result = summary(plan, rows, problems);
  write_whole(plan.output / "shootout.csv", table(plan, rows, problems));
  write_whole(plan.output / "summary.csv", csv(result));
  write_whole(plan.output / "paths.csv", paths(plan, rows, problems));
  auto about = manifest();
  about["command"] = command_line;
  about["options"] = {{"solvers", plan.solvers},      {"families", plan.choice.families},
                      {"scenes", plan.choice.scenes}, {"problems", plan.choice.problems},
                      {"rivals", plan.rivals_folder}, {"largest", plan.choice.largest},
                      {"seeds", plan.choice.seeds},   {"time_limit", plan.time_limit},
                      {"memory", plan.memory},        {"jobs", plan.jobs},
                      {"quick", plan.quick}};
  write_whole(plan.output / "manifest.json", about.dump(2) + "\n");
  print(result);
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  CLI::App app("Every solver on families of problems: speed against achieved residual, claims checked");
  app.add_option("--output", plan.output, "folder for tables and manifest")->capture_default_str();
  app.add_option("--solvers", plan.solvers, "NAME[:option=value,...] ...; default: all of the registry");
  app.add_option("--rivals", plan.rivals_folder, "folder of rivals' drivers; they take part as well");
  app.add_option("--families", plan.choice.families, "names of core/lcp/families.h, known, steps; default: all");
  app.add_option("--scenes", plan.choice.scenes, "scenes whose steps are recorded")->capture_default_str();
  app.add_option("--problems", plan.choice.problems, "problem files as well");
  const auto* largest = app.add_option("--largest", plan.choice.largest, "no families' problems larger than this");
  app.add_option("--seeds", plan.choice.seeds, "of random families")->check(CLI::Range(1, 1000))->capture_default_str();
  const auto* limit = app.add_option("--time-limit", plan.time_limit, "of a solve [s]; killed after 1.5 times that")
                          ->check(CLI::Range(1e-6, 1e6))
                          ->capture_default_str();
  app.add_option("--memory", plan.memory, "of a solve [GB], 0: no limit")->check(CLI::Range(0.0, 1e6));
  app.add_option("--jobs", plan.jobs, "processes at a time; more than 1 disturb each other's times")
      ->check(CLI::Range(1U, 1024U))
      ->capture_default_str();
  app.add_flag("--quick", plan.quick, "smallest sizes, 0.3 s a solve");
  CLI11_PARSE(app, argc, argv);
  plan.choice.smallest_only = plan.quick && largest->count() == 0;
  if (plan.quick && limit->count() == 0) plan.time_limit = 0.3;
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  try {
    if (plan.solvers.empty())
      for (const SolverEntry& entry : solvers()) plan.solvers.emplace_back(entry.name);
    for (const std::string& spec : plan.solvers) make_solver(spec);  // unknown: said at once
    if (!plan.rivals_folder.empty()) plan.rivals = rivals(plan.rivals_folder);
    for (const Rival& rival : plan.rivals) plan.solvers.push_back(rival.name);
    run(plan, command_line);
  } catch (const std::exception& error) {
    std::cerr << "lcp_shootout: " << error.what() << '\n';
    return 1;
  }
}
