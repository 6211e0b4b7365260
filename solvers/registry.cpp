#include <orthant/solvers/registry.h>

#include <orthant/core/support/options.h>
#include <orthant/solvers/enumerate.h>
#include <orthant/solvers/lemke.h>
#include <orthant/solvers/pgs.h>

#include <stdexcept>

namespace orthant {

namespace {

template <class S> std::unique_ptr<Solver> make(std::string_view text) {
  typename S::Options options;
  set_options(options, text);
  return std::make_unique<S>(options);
}

template <class S> std::string options() { return describe(typename S::Options{}); }

constexpr SolverEntry kSolvers[] = {
    {"lemke", "lexicographic Lemke pivoting; ends on a solution or a ray", &make<Lemke>, &options<Lemke>},
    {"pgs", "projected Gauss-Seidel sweeps, friction rows included; A_ii > 0", &make<Pgs>, &options<Pgs>},
    {"enumerate", "every basis in turn, at most 16 complementary rows; the oracle of the tests", &make<Enumerate>,
     &options<Enumerate>},
};

}  // namespace

std::span<const SolverEntry> solvers() { return kSolvers; }

std::unique_ptr<Solver> make_solver(std::string_view spec) {
  const auto [name, text] = Spec::parse(spec);
  std::string names;
  for (const SolverEntry& entry : kSolvers) {
    if (entry.name == name) return entry.make(text);
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("solver '" + std::string(name) + "': must be one of " + names);
}

}  // namespace orthant
