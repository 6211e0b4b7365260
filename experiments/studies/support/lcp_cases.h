// experiments/studies/support/lcp_cases.h — LCP test cases: problems on which solvers are compared, from four sources.
//
//   families       core/lcp/problems/families.h: size × hardness × seed
//   "known"        core/lcp/problems/collection.h: small ones with exact answers
//   "file"         problem files (problem_file.h)
//   "steps"        the problems of a scene's time steps, recorded from a run
#pragma once

#include <orthant/core/lcp/problems/families.h>

#include <functional>
#include <optional>

namespace orthant {

struct LcpCase {
  std::string family, name;  // name: unique within a run
  Index size = 0;            // nominal
  double hardness = 0;
  std::uint64_t seed = 0;
  std::string matrix;            // class, where it is known
  std::optional<Answer> answer;  // empty: nothing is known
  std::function<Lcp()> make;
};

struct LcpCaseChoice {
  std::vector<std::string> families;                // empty: all, "known" and "steps" included
  Index largest = 1 << 30;                          // nominal size
  int seeds = 1;                                    // 1, 2, …; problems that do not depend on it are made once
  bool smallest_only = false;                       // one size a family
  std::vector<std::string> problems;                // files
  std::vector<std::string> scenes{"slider_crank"};  // built-in or TOML
};

/// Small sizes first. Throws std::invalid_argument for an unknown family, and what reading files and scenes throws.
std::vector<LcpCase> lcp_cases(const LcpCaseChoice& choice);

/// Kind of problem, in one or two words: "friction", "infeasible", "definite", "semidefinite", "grid",
/// "P-matrix", "other"; "own" of files, whatever they hold.
std::string group(const LcpCase& c, const Lcp& problem);

}  // namespace orthant
