// solvers/registry.h — solver registry: names, summaries and options in one table (registry.cpp).
#pragma once

#include <orthant/core/support/option_list.h>
#include <orthant/solvers/solver.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

struct SolverEntry {
  std::string_view name, summary;
  std::unique_ptr<Solver> (*make)(std::string_view options);  // "omega=1.3,max_sweeps=50"
  std::vector<OptionEntry> (*options)();                      // with defaults and ranges
};

std::span<const SolverEntry> solvers();

/// "pgs:omega=1.3" (also the label in every table). Throws std::invalid_argument: an unknown name lists the names.
std::unique_ptr<Solver> make_solver(std::string_view spec);

}  // namespace orthant
