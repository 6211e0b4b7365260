// experiments/studies/support/rivals.h — rival programs: solvers and simulators of others, a process each.
//
//   A rival is an executable that, called without arguments, prints a line for each of its methods: the name, then what
//   it takes. One that cannot be had is an executable that fails with words: it stays in the tables, as absent.
//   Own processes, because their symbols clash and their crashes and endless loops shall be rows. Nothing of theirs is
//   linked; the drivers and how they are built: experiments/benchmarks.
#pragma once

#include "experiments/studies/support/lcp_trial.h"

#include <filesystem>
#include <vector>

namespace orthant {

struct Rival {
  std::string name;  // "siconos/lemke"
  std::filesystem::path program;
  std::string method;  // its name for it; empty: absent
  std::string takes;   // LCP solvers: pure, boxes or friction; else free words
  std::string absent;  // why, in words; empty: it is there
};

/// All methods of a folder's drivers, by name. Only what its drivers.txt names is started, a file a line. Throws
/// std::invalid_argument when there is no such list.
std::vector<Rival> rivals(const std::filesystem::path& folder);

/// Output of a program. Throws std::runtime_error with its error stream, or its signal, if the exit code is not 0. The
/// program dies with this process; call it within Isolated where a time limit matters.
std::string output_of(const std::vector<std::string>& command);

/// A rival's answer to an unscaled problem, which it reads from a file; claim, iterations, time and note go into
/// `trial`, unjudged. No answer: NaN.
Vector answer_of_rival(const Lcp& problem, const Rival& rival, double tolerance, Trial& trial);

/// An LCP by a rival: handed over in a file, solved by its driver, and judged here like try_solver()'s. A solver of
/// pure problems gets boxes and friction as added rows (pure_form.h, Stewart and Trinkle's form, copositive: Lemke's
/// method has its guarantee), untimed; free rows it does not take. `tolerance` is for iterative solvers: a decade
/// below what is judged, so that another norm in a stopping rule does not make an answer a wrong one.
Trial try_rival(const Lcp& problem, const Rival& rival, double tolerance = 1e-11);

}  // namespace orthant
