// Ten bricks in a pyramid at rest, after a report to another engine (dartsim/dart#1068): redundant contacts with
// friction between equal masses. Ties that rounding has broken led Lemke's path round in circles.
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>

using namespace orthant;

TEST_CASE("a pyramid of ten bricks stays, and no step takes lemke or auto more than a few thousand pivots") {
  const System system(read_scene(ORTHANT_ROOT "/tests/data/ten_bricks.toml"));
  for (const char* solver : {"lemke", "auto", "nncg"}) {
    CAPTURE(solver);
    const auto by = make_solver(solver);
    const auto scheme = make_integrator("moreau-jean", system);
    State x = system.initial_state();
    const Eigen::VectorXd q = x.q;
    int most = 0;
    for (int k = 0; k < 200; ++k) {
      const StepReport report = scheme->step(5e-3, *by, x);
      REQUIRE(report.status == Status::solved);
      most = std::max(most, report.lcp_iterations);
    }
    CHECK(most <= 4000);
    CHECK((x.q - q).lpNorm<Eigen::Infinity>() < 1e-9);
  }
}
