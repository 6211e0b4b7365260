// A solver of your own, plugged in: projected Gauss-Seidel for dense problems. The judge stays Orthant's.
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>

#include <algorithm>
#include <iostream>

class Mine final : public orthant::Solver {
  orthant::Claim run(const orthant::Lcp& p, orthant::Solution& s, orthant::Start) override {
    const auto& M = std::get<orthant::DenseMatrix>(p.A);
    for (s.iterations = 0; s.iterations < 1000 && !passes(p, s); ++s.iterations)  // passes(): asks the judge
      for (orthant::Index i = 0; i < p.size(); ++i)
        s.z[i] = std::clamp(s.z[i] - (M.row(i).dot(s.z) + p.b[i]) / M(i, i), p.lo[i], p.hi[i]);
    return orthant::Claim::candidate;  // please judge
  }
  std::string why_not(const orthant::Lcp& p) const override {
    return p.friction.empty() && std::holds_alternative<orthant::DenseMatrix>(p.A) ? "" : "dense, no friction";
  }
  double tolerance() const override { return 1e-10; }
};

int main() {
  const orthant::System system(orthant::slider_crank({.mu = 0}));
  Mine solver;
  const auto run = simulate(*make_integrator("moreau-jean", system), solver, {.step = 1e-4, .duration = 0.1});
  std::cout << name(run.status) << ": " << run.lcp_solves << " problems by a solver of our own\n";
  return run.status == orthant::Status::solved ? 0 : 1;
}
