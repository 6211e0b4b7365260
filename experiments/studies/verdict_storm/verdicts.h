// experiments/studies/verdict_storm/verdicts.h — verdicts of every solver on thousands of problems, checked again.
//
//   Problems of discs are restated in other words, too (disc_problems.h): a solution of the one must solve the other by
//   both judges, and the solver must not claim the contrary. A fault of that kind counts as wrong.
#pragma once

#include "experiments/studies/verdict_storm/problems.h"

#include <array>
#include <map>
#include <string>
#include <vector>

namespace orthant {

/// Result of one solver on one problem.
enum class StormResult { solved, rounded, infeasible, refused, failed, wrong, late, crashed };
inline constexpr std::array<std::string_view, 8> kStormResults{"solved", "rounded", "infeasible", "refused",
                                                               "failed", "wrong",   "late",       "crashed"};

struct StormFault {
  std::uint64_t k = 0;  // the problem's number
  std::string kind, solver, what, why;
};

struct StormTally {
  struct Row {
    std::array<long, kStormResults.size()> count{};
    double error = 0;             // the largest of solutions that hold (exact_judge.h)
    long exact = 0, rounded = 0;  // proofs, by κ
  };
  std::map<std::pair<std::string, std::string>, Row> rows;  // by kind and solver
  std::vector<StormFault> faults;

  void add(const StormTally& other);
};

struct StormSolver {
  std::string spec;
  int every = 1;            // meets every so-many-th problem of a kind
  Index largest = 1 << 20;  // [rows] problems beyond are not given to it
};

/// Every solver of the registry; those that take milliseconds a problem meet fewer.
std::vector<StormSolver> storm_solvers();

/// Those that take friction discs; answers by facets are held to 1e-8 only, and are tested elsewhere.
std::vector<StormSolver> disc_solvers();

struct StormChoice {
  std::uint64_t seed = 1;
  bool discs = false;  // disc_problems.h instead of problems.h
  std::vector<StormSolver> solvers = storm_solvers();
  std::size_t solvers_each = 0;  // of them to a problem, and auto; 0: all
  double time_limit = 2;         // [s] of each solve in every 41st turn of all kinds; 0.002 in the others
  double grace = 1;              // [s] past it a solve is late
};

StormProblem problem_of(const StormChoice& choice, std::uint64_t k);

/// Places in choice.solvers of those that meet problem k. With solvers_each they are dealt by the seed: of ⌈S / N⌉
/// problems of a kind in a row, S solvers without auto, N to each problem, every one meets one; auto meets all.
std::vector<std::size_t> solvers_of(const StormChoice& choice, std::uint64_t k);

/// Problems first … first + count − 1. Solvers live through all of them, so what one leaves behind is tried, too. A
/// crash or an endless loop ends this process: the caller isolates (isolated.h).
StormTally storm(const StormChoice& choice, std::uint64_t first, std::uint64_t count);

/// "wrong", "late" or "" of one solver on one problem, in words in `why`; `answer` as far as known.
StormResult storm_one(const Lcp& problem, std::optional<Answer> answer, const std::string& spec,
                      const StormChoice& choice, std::string& why);

std::string to_text(const StormTally& tally);
StormTally storm_tally_from_text(const std::string& text);

}  // namespace orthant
