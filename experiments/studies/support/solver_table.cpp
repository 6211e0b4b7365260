#include "experiments/studies/support/solver_table.h"

#include "experiments/support/isolated.h"
#include "experiments/support/progress.h"

#include <orthant/core/support/options.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <iomanip>
#include <map>
#include <sstream>

namespace orthant {
namespace {

/// A solver out of time on a problem skips larger ones of that family and hardness.
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

/// A rival must reach more digits than the judge requires: an answer that passes is right, though it says it failed.
void accept_unsaid(Trial& t, const std::optional<Answer>& answer) {
  if (t.status != "failed" || !t.holds || answer == Answer::none || answer == Answer::infeasible) return;
  t.note = "says failed" + (t.note.empty() ? "" : ", " + t.note);
  t.status = name(Status::solved);
}

/// What only the whole table tells: who was fastest, and whether somebody solved what others call infeasible.
void compare(SolverTable& table) {
  auto& [solvers, problems, rows] = table;
  for (const SolverTable::Row& row : rows)
    problems[row.problem].solvable |= row.result == Result::certified && row.trial.status != name(Status::infeasible);
  for (SolverTable::Row& row : rows) {
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

}  // namespace

SolverTable try_all(std::vector<std::string> solvers, const std::vector<Rival>& rivals,
                    const std::vector<LcpCase>& cases, const TrialLimits& limits,
                    const std::function<void(const SolverTable&)>& save) {
  const auto work_of = [](const LcpCase& c) { return std::sqrt(static_cast<double>(c.size)); };  // a rough guess
  SolverTable table{std::move(solvers), {}, {}};
  for (const Rival& rival : rivals) table.solvers.push_back(rival.name);
  double work = 0;
  for (const LcpCase& c : cases) work += work_of(c) * static_cast<double>(table.solvers.size());
  Progress progress("shootout", work);
  table.rows.reserve(cases.size() * table.solvers.size());
  OutOfTime out_of_time;
  Isolated processes(limits.jobs, static_cast<std::size_t>(limits.memory * 0x1p30));
  auto saved = std::chrono::steady_clock::now();
  for (std::size_t p = 0; p < cases.size(); ++p) {
    if (std::chrono::steady_clock::now() - saved > std::chrono::minutes(1)) {
      save(table);
      saved = std::chrono::steady_clock::now();
    }
    const LcpCase& c = cases[p];
    const Lcp problem = c.make();
    table.problems.push_back({c, group(c, problem), problem.size(), 1 + problem.b.lpNorm<Eigen::Infinity>()});
    for (std::size_t s = 0; s < table.solvers.size(); ++s) {
      SolverTable::Row& row = table.rows.emplace_back(SolverTable::Row{p, s, {}, Result::skipped});
      const std::string& spec = table.solvers[s];
      const double step = work_of(c);
      processes.wait_for_room();  // the last result may make this one hopeless
      if (out_of_time.hopeless(spec, c)) {
        row.trial.note = "out of time on a smaller one";
        progress.add(step, false);
        continue;
      }
      const auto rival = std::ranges::find(rivals, spec, &Rival::name);
      const bool ours = rival == rivals.end();
      processes.start(
          [&] { return to_text(ours ? try_solver(problem, spec, limits.time) : try_rival(problem, *rival)); },
          1.5 * limits.time + (ours ? 0.1 : 3),  // [s] the rest: to start, and to be judged
          [&row, &c, &spec, &progress, &out_of_time, step, ours](const Outcome& outcome) {
            row.trial = trial_of(outcome);
            if (!ours) accept_unsaid(row.trial, c.answer);
            row.result = judge(row.trial, c.answer);
            out_of_time.note(spec, c, row.trial);
            const auto is = [&row](Result result) { return row.result == result; };
            progress.add(step, is(Result::wrong) || is(Result::crashed) || is(Result::late));
          });
    }
  }
  processes.wait_for_all();
  compare(table);
  return table;
}

std::string SolverTable::csv() const {
  std::string text =
      "problem,family,group,n,hardness,seed,solver,result,status,iterations,runs,seconds,residual,relative_residual,"
      "rounding,stages,note\n";
  for (const auto& [p, s, t, result] : rows) {
    const auto& [about, group, n, scale, best, solvable] = problems[p];
    text += quoted(about.name) + ',' + about.family + ',' + group + ',' + std::to_string(n) + ',' +
            number(about.hardness) + ',' + std::to_string(about.seed) + ',' + quoted(solvers[s]) + ',' + name(result) +
            ',' + t.status + ',' + std::to_string(t.iterations) + ',' + std::to_string(t.runs);
    for (const double x : {t.seconds, t.residual, t.residual / scale, t.rounding}) text += ',' + number(x);
    text += ',' + quoted(t.stages) + ',' + quoted(t.note) + '\n';
  }
  return text;
}

SolverTable::Cells SolverTable::summary() const {
  Cells table{{"solver", "problems"}};
  for (int v = 0; v < kResults; ++v) table[0].emplace_back(name(static_cast<Result>(v)));
  table[0].emplace_back("median_time_to_best");
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    std::array<int, kResults> count{};
    std::vector<double> ratios;
    for (const Row& row : rows) {
      if (row.solver != s) continue;
      ++count[static_cast<std::size_t>(row.result)];
      if (row.result == Result::certified) ratios.push_back(row.trial.seconds / problems[row.problem].best);
    }
    auto& line = table.emplace_back(std::vector{solvers[s], std::to_string(problems.size())});
    for (const int c : count) line.push_back(std::to_string(c));
    std::ranges::sort(ratios);
    std::ostringstream ratio;
    if (!ratios.empty()) ratio << std::setprecision(3) << ratios[ratios.size() / 2];
    line.push_back(ratio.str());
  }
  return table;
}

SolverTable::Cells SolverTable::regret(const std::string& solver) const {
  const auto place = static_cast<std::size_t>(std::ranges::find(solvers, solver) - solvers.begin());
  struct Times {
    double best = kInf, own = kInf;
    std::size_t fastest = 0;
  };
  std::vector<Times> times(problems.size());
  for (const Row& row : rows) {
    if (row.result != Result::certified) continue;
    Times& t = times[row.problem];
    if (row.solver == place) t.own = row.trial.seconds;
    if (row.trial.seconds < t.best) t.best = row.trial.seconds, t.fastest = row.solver;
  }
  std::vector<std::size_t> order;
  for (std::size_t p = 0; p < problems.size(); ++p)
    if (times[p].best < kInf) order.push_back(p);
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t p) { return times[p].own / times[p].best; });
  Cells table{{"problem", "family", "n", "fastest", "seconds", solver, "regret"}};
  for (const std::size_t p : order) {
    const auto& [best, own, fastest] = times[p];
    table.push_back({problems[p].about.name, problems[p].about.family, std::to_string(problems[p].n),
                     quoted(solvers[fastest]), number(best), number(own), number(own / best)});
  }
  return table;
}

std::string SolverTable::paths_csv() const {
  std::map<std::array<std::string, 3>, std::array<int, 2>> count;  // certified, others
  for (const Row& row : rows)
    if (row.result != Result::refused && row.result != Result::skipped)
      ++count[{solvers[row.solver], problems[row.problem].about.family, row.trial.stages}]
             [row.result == Result::certified ? 0 : 1];
  std::string text = "solver,family,stages,certified,not_certified\n";
  for (const auto& [key, n] : count)
    text += quoted(key[0]) + ',' + key[1] + ',' + quoted(key[2]) + ',' + std::to_string(n[0]) + ',' +
            std::to_string(n[1]) + '\n';
  return text;
}

std::string to_csv(const SolverTable::Cells& table) {
  std::string text;
  for (const auto& line : table)
    for (std::size_t i = 0; i < line.size(); ++i)
      text += (&line != &table[0] && i == 0 ? quoted(line[i]) : line[i]) + (i + 1 < line.size() ? ',' : '\n');
  return text;
}

}  // namespace orthant
