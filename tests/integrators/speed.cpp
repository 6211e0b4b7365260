// Speed does not get lost unnoticed: times as ratios to a fixed kernel in the same run, never by the clock alone.
#include <orthant/core/lcp/collection.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "experiments/support/reference_kernel.h"

using namespace orthant;

namespace {

/// Units a step.
[[maybe_unused]] double step_cost(const Scene& scene, double h, long steps) {
  const System system(scene);
  const auto integrator = make_integrator("moreau-jean", system);
  const auto solver = make_solver("auto");
  const double duration = h * static_cast<double>(steps);
  const auto run = [&] { simulate(*integrator, *solver, {.step = h, .duration = duration, .every = steps}); };
  return units(15, run) / static_cast<double>(steps);
}

}  // namespace

TEST_SUITE("slow") {  // not where sanitizers or missing optimization decide what is slow
  TEST_CASE("speed: a step, a link of a chain, a small problem and a pivot cost what they did") {
#ifdef NDEBUG
    const double slider_crank_step = step_cost(slider_crank(), 1e-5, 2000);
    const double chain_link = step_cost(chain({.links = 100}), 1e-3, 20) / 100;
    Random random(1);
    const Lcp small = random_spd_problem(10, random), middle = random_spd_problem(100, random);
    Solution s;
    const auto automatic = make_solver("auto"), lemke = make_solver("lemke:form=tableau");
    const double problem = units(15,
                                 [&] {
                                   for (int k = 0; k < 20; ++k) automatic->solve(small, s);
                                 }) /
                           20;
    const double pivot = units(15, [&] { lemke->solve(middle, s); }) / s.iterations;
    INFO("units: step ", slider_crank_step, ", link ", chain_link, ", problem ", problem, ", pivot ", pivot);
    // Measured 0.21, 0.105, 0.17 to 0.22 and 0.80 to 1.04 (on a busy machine); beyond 1.6 times that something is lost.
    CHECK(slider_crank_step < 0.34);
    CHECK(chain_link < 0.17);
    CHECK(problem < 0.35);
    CHECK(pivot < 1.65);
#endif
  }
}
