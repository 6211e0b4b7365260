// Poisson's law: the bounds of its second phase are shares of the impulses of the first.
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/integrators/step/step_problem.h>

#include "tests/support/spatial.h"

using namespace orthant;

TEST_CASE("Poisson's law: an impulse of -1e-13 that a solver leaves for 0 gives no bound below 0") {
  spatial::Scene s;
  const auto ball = s.body({.name = "ball", .inertia = Eigen::Matrix3d::Identity(), .position = {0, 0, 0.1}});
  spatial::SpherePlane floor{.name = "floor", .a = ball, .law = {.mu = 0.5, .e = 0.4}};
  floor.radius = 0.1;
  s.contact(floor);
  const SpatialSystem system(s);
  const State x = system.initial_state();
  TermsOf<Spatial> terms(system);
  set_poses(system, 0, x.q, terms.at);
  evaluate_gaps(system, terms);
  evaluate_closed(system, 1e-9, terms);
  REQUIRE(terms.closed.size() == 1);
  std::vector<RateTargetOf<Spatial>> targets;
  newtons_law(system.laws(), terms, x.v, targets);
  StepProblemOf<Spatial> problem(system, Form::reduced, Cone::coulomb);
  BasicSystemOf<Spatial> basic(system, false);
  REQUIRE(basic.factorize(system, terms, 0, 0));
  problem.collect(terms, targets, {});
  problem.respond(basic);
  problem.retarget(targets, x.v, {});
  for (const double stored : {-1e-13, 0.0, 2.0}) {
    problem.release({{stored, {}}});
    CHECK_NOTHROW(check(problem.whole()));
    CHECK(problem.whole().lo[0] == 0.4 * std::max(0.0, stored));
  }
}
