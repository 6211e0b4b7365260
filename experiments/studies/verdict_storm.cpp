// Verdict storm: random problems of every kind by every solver, each verdict checked in exact arithmetic.
//
//   build/release/experiments/verdict_storm                 10⁶ problems by all solvers, 15 h of a core; resumes
//   build/release/experiments/verdict_storm --solvers-each 3   each by auto and 3 solvers in turn, 1 h of a core
//   build/release/experiments/verdict_storm --problems 5000 a share
//   build/release/experiments/verdict_storm --only 123456   one problem, by its number
//   build/release/experiments/verdict_storm --discs --output results/disc_storm   contacts with friction discs
//
// Files in the output folder: chunks.jsonl (one line per finished chunk; a killed run resumes),
// verdict_storm.csv (counts of outcomes by kind and solver), fault_*.json (each fault's problem, reduced, for orthant
// replay).
// Crashes and endless loops end a process of their own. Exit code 3 when there is a fault.
#include "experiments/studies/verdict_storm/shrink.h"
#include "experiments/studies/verdict_storm/verdicts.h"
#include "experiments/support/between.h"
#include "experiments/support/chunks.h"
#include "experiments/support/command_line.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <fstream>
#include <iostream>
#include <set>
#include <sstream>

using namespace orthant;

namespace {

struct Arguments {
  std::filesystem::path output = "results/verdict_storm";
  std::uint64_t problems = 1000000, chunk = 200;
  StormChoice choice;
  std::vector<std::string> specs;
  std::optional<std::uint64_t> only;
  unsigned jobs = 1;
  std::size_t memory = 4096;  // [MiB]
  long shrunk = 20;
};

struct Storm {
  const Arguments& a;
  Isolated processes;

  double most_seconds(std::uint64_t count, std::size_t solvers) const {
    return 60 + 0.2 * static_cast<double>(count * solvers) + 2 * (a.choice.time_limit + a.choice.grace);
  }

  /// A chunk that did not come back is done again problem by problem, a problem solver by solver.
  StormTally corner(std::uint64_t first, std::uint64_t count, const StormChoice& choice) {
    StormTally tally;
    std::optional<Outcome> outcome;
    processes.start([=] { return to_text(storm(choice, first, count)); }, most_seconds(count, choice.solvers.size()),
                    [&](const Outcome& o) { outcome = o; });
    processes.wait_for_all();
    if (outcome->kind == Outcome::finished) return storm_tally_from_text(outcome->text);
    if (count > 1) {
      for (std::uint64_t k = first; k < first + count; ++k) tally.add(corner(k, 1, choice));
    } else if (choice.solvers.size() > 1) {
      for (const std::size_t place : solvers_of(choice, first)) {
        StormChoice one = choice;
        one.solvers = {choice.solvers[place]}, one.solvers_each = 0;
        tally.add(corner(first, 1, one));
      }
    } else {
      const std::string kind(problem_of(choice, first).kind), &solver = choice.solvers[0].spec;
      const auto what = outcome->kind == Outcome::killed ? StormResult::late : StormResult::crashed;
      ++tally.rows[{kind, solver}].count[static_cast<std::size_t>(what)];
      tally.faults.push_back(
          {first, kind, solver, std::string(kStormResults[static_cast<std::size_t>(what)]), outcome->text});
    }
    return tally;
  }

  StormTally run(const std::string& header) {
    const ChunkWork work{.work = [this](auto first, auto count) { return to_text(storm(a.choice, first, count)); },
                         .limit = [this](auto count) { return most_seconds(count, a.choice.solvers.size()); },
                         .again = [this](auto first, auto count) { return to_text(corner(first, count, a.choice)); },
                         .faulty = [](const std::string& text) { return !storm_tally_from_text(text).faults.empty(); }};
    StormTally all;
    for (const auto& [first, text] :
         run_chunks({"storm", a.output / "chunks.jsonl", header, a.problems, a.chunk}, work, processes))
      all.add(storm_tally_from_text(text));
    return all;
  }

  /// The fault's problem, as small as it gets, in a process of its own at every try.
  void shrink_fault(const StormFault& fault) {
    const StormProblem p = problem_of(a.choice, fault.k);
    const auto outcome_of = [&](const Lcp& problem) {
      std::string what;
      processes.start(
          [&, this] {
            std::string why;
            return std::string(
                kStormResults[static_cast<std::size_t>(storm_one(problem, {}, fault.solver, a.choice, why))]);
          },
          2 * (a.choice.time_limit + a.choice.grace),
          [&](const Outcome& o) {
            what = o.kind == Outcome::finished ? o.text : o.kind == Outcome::killed ? "late" : "crashed";
          });
      processes.wait_for_all();
      return what;
    };
    const auto shows = [&](const Lcp& problem) { return outcome_of(problem) == fault.what; };
    const bool alone = shows(p.problem);  // else it takes another solver's answer, or what came before
    const Lcp least = alone ? shrink(p.problem, shows) : p.problem;
    const auto file =
        a.output / ("fault_" + std::to_string(fault.k) + "_" + std::string(Spec::parse(fault.solver).name) + ".json");
    write_problem(file, least,
                  fault.kind + " " + std::to_string(fault.k) + ", " + fault.solver + ": " + fault.what + ", " +
                      fault.why + (alone ? "" : " (only together with or after others)"));
    std::cerr << "  " << file.string() << ", " << least.size() << " rows\n";
  }
};

void write_table(const std::filesystem::path& file, const StormTally& all) {
  std::ostringstream out;
  out << "kind,solver";
  for (const auto& what : kStormResults) out << ',' << what;
  out << ",worst_error,proofs_exact,proofs_to_rounding\n";
  for (const auto& [key, row] : all.rows) {
    out << key.first << ',' << key.second;
    for (const long count : row.count) out << ',' << count;
    out << ',' << row.error << ',' << row.exact << ',' << row.rounded << '\n';
  }
  write_whole(file, out.str());
}

int report(const StormTally& all, std::uint64_t problems) {
  std::map<std::string, StormTally::Row> by_solver;
  StormTally::Row sum;
  for (const auto& [key, row] : all.rows)
    for (std::size_t i = 0; i < row.count.size(); ++i)
      by_solver[key.second].count[i] += row.count[i], sum.count[i] += row.count[i];
  std::cout << problems << " problems\n| solver |";
  for (const auto& what : kStormResults) std::cout << ' ' << what << " |";
  std::cout << "\n|---|" << [] {
    std::string line;
    for (std::size_t i = 0; i < kStormResults.size(); ++i) line += "---|";
    return line;
  }() << '\n';
  by_solver["all"] = sum;
  for (const auto& [solver, row] : by_solver) {
    std::cout << "| " << solver << " |";
    for (const long count : row.count) std::cout << ' ' << count << " |";
    std::cout << '\n';
  }
  return all.faults.empty() ? 0 : 3;
}

int run(Arguments a) {
  if (a.choice.discs) a.choice.solvers = disc_solvers();
  if (!a.specs.empty()) {
    a.choice.solvers.clear();
    for (const std::string& spec : a.specs) make_solver(spec), a.choice.solvers.push_back({spec});  // known ones only
  }
  std::filesystem::create_directories(a.output);
  std::vector<std::string> names;
  if (a.choice.solvers_each > 0) names.push_back("each=" + std::to_string(a.choice.solvers_each));
  for (const StormSolver& solver : a.choice.solvers) names.push_back(solver.spec);
  Storm storm_of{a, Isolated(a.jobs, a.memory << 20)};
  StormTally all;
  if (a.only) {
    all = storm_of.corner(*a.only, 1, a.choice);
  } else {
    all = storm_of.run(chunk_header(a.choice.seed, a.chunk, names));
    write_table(a.output / "verdict_storm.csv", all);
  }
  const int exit_code = report(all, a.only ? 1 : a.problems);
  long left = a.shrunk;
  for (const StormFault& f : all.faults) {
    std::cerr << "verdict_storm: problem " << f.k << " (" << f.kind << "), " << f.solver << ": " << f.what << ": "
              << f.why << '\n';
    if (left-- > 0) storm_of.shrink_fault(f);
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Random problems of every kind through every solver, each verdict checked again in exact arithmetic");
  Arguments a;
  const auto kCount = CLI::Range(0L, 1'000'000'000'000L);
  app.add_option("--output", a.output, "folder")->capture_default_str();
  app.add_option("--problems", a.problems, "how many")->check(kCount)->capture_default_str();
  app.add_option("--seed", a.choice.seed, "")->capture_default_str();
  app.add_flag("--discs", a.choice.discs, "contact problems with friction discs (Coulomb's cone in space)");
  app.add_option("--solvers", a.specs, "as in orthant list, with options; default: all");
  app.add_option("--solvers-each", a.choice.solvers_each, "to each problem auto and so many of them in turn; 0: all")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  app.add_option("--only", a.only, "one problem, by its number")->check(kCount);
  app.add_option("--time-limit", a.choice.time_limit, "of a solve [s]")
      ->check(between(1e-3, 1e6))
      ->capture_default_str();
  app.add_option("--jobs", a.jobs, "processes at a time")->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_option("--chunk", a.chunk, "problems a process")->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--memory", a.memory, "of a process [MiB]; 0: no limit")->capture_default_str();
  app.add_option("--shrink", a.shrunk, "at most so many faults")->check(CLI::Range(0, 1000000))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  try {
    return run(std::move(a));
  } catch (const std::exception& error) {
    std::cerr << "verdict_storm: " << error.what() << '\n';
    return 1;
  }
}
