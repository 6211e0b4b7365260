#include <orthant/core/lcp/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

using namespace orthant;

namespace {

/// ‖min(z, w)‖∞ ≤ max(1e-10 (1 + ‖q‖∞), 20 ρ), ρ ≤ 1e-6 (1 + ‖q‖∞): measured here, from z alone.
bool passes(const Lcp& problem, const Vector& z) {
  const auto& M = std::get<DenseMatrix>(problem.A);
  const Eigen::VectorXd w = M * z + problem.b;
  const double rho =
      std::numeric_limits<double>::epsilon() * (problem.b.cwiseAbs() + M.cwiseAbs() * z.cwiseAbs()).maxCoeff();
  const double q = 1 + problem.b.lpNorm<Eigen::Infinity>();
  return z.cwiseMin(w).lpNorm<Eigen::Infinity>() <= std::max(1e-10 * q, 20 * rho) && rho <= 1e-6 * q;
}

void all_pass(const char* spec, Index contacts, double mu, double mass_ratio, int seeds) {
  for (int seed = 0; seed < seeds; ++seed) {
    Random random(static_cast<std::uint64_t>(1000 * seed) + static_cast<std::uint64_t>(mass_ratio));
    const Lcp problem = stewart_trinkle_problem(contacts, mu, mass_ratio, random);
    const auto solver = make_solver(spec);
    Solution s;
    solver->solve(problem, s);
    INFO(spec, ", n = ", 4 * contacts, ", mass ratio ", mass_ratio, ", seed ", seed, ": ", name(s.status));
    CHECK(s.status == Status::solved);
    CHECK(passes(problem, s.z));
  }
}

}  // namespace

TEST_CASE("friction in Stewart and Trinkle's form is solved whatever the mass ratio") {
  for (const char* spec : {"lemke", "path"})
    for (const double ratio : {1.0, 1e6, 1e10}) {
      all_pass(spec, 5, 0.5, ratio, 30);
      all_pass(spec, 20, 0.5, ratio, 30);
    }
}

TEST_SUITE("slow") {
  TEST_CASE("friction in Stewart and Trinkle's form, 60 and 100 contacts") {
    for (const char* spec : {"lemke", "path"}) {
      for (const double ratio : {1.0, 1e6, 1e10}) all_pass(spec, 60, 0.5, ratio, 10);
      for (const double ratio : {1.0, 1e6, 1e10}) all_pass(spec, 100, 0.8, ratio, 2);
    }
  }
}
