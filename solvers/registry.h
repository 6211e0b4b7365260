// solvers/registry.h — solver registry: names, summaries and options in one table (registry.cpp).
#pragma once

#include <orthant/core/support/option_list.h>
#include <orthant/core/support/options.h>
#include <orthant/solvers/solver.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

struct SolverEntry {
  std::string_view name, summary;
  std::function<std::unique_ptr<Solver>(std::string_view options)> make;  // "omega=1.3,max_sweeps=50"
  std::function<std::vector<OptionEntry>()> options;                      // with defaults and ranges
};

std::span<const SolverEntry> solvers();

/// A method's options, and those that all solvers have.
template <class Own> struct SolverOptions {
  Own own;
  int facets = 0;  // sides of the pyramids in place of friction discs; 0: discs
  template <class V> void visit(V&& v) {
    own.visit(v);
    v("facets", facets, 0, 1024);
  }
};

template <class S> std::unique_ptr<Solver> make_with_options(std::string_view text) {
  SolverOptions<typename S::Options> options;
  set_options(options, text);
  std::unique_ptr<Solver> solver = std::make_unique<S>(options.own);
  solver->set_pyramids(options.facets);
  return solver;
}

/// One more row, behind the others: make_solver(), the command, sweeps and the shoot-out know its name from then on.
/// Name and summary are copied. Not while another thread uses the registry. Throws std::invalid_argument for a name
/// that is taken, or made of other than a–z, 0–9 and -.
void register_solver(SolverEntry entry);

/// The same of a class with `Options` as the built-in ones have: register_solver<Mine>("mine", "what it is").
template <class S> void register_solver(std::string_view name, std::string_view summary) {
  register_solver(SolverEntry{name, summary, &make_with_options<S>,
                              [] { return list_options<SolverOptions<typename S::Options>>(); }});
}

/// "pgs:omega=1.3" (also the label in every table). Throws std::invalid_argument: an unknown name lists the names.
std::unique_ptr<Solver> make_solver(std::string_view spec);

}  // namespace orthant
