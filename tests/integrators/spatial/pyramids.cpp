// Friction pyramids in place of discs, by the solvers' option `facets`: the exact motion of each, and what is refused.
#include "tests/support/spatial.h"

#include <orthant/core/scenes/cross_slope.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

using namespace orthant;

namespace {

Vector3d rests_at(const CrossSlope& p, const std::string& solver, double step,
                  const std::string& integrator = "moreau-jean") {
  const SpatialSystem system(cross_slope(p));
  const auto scheme = make_integrator(integrator, system);
  const auto method = make_solver(solver);
  const Run run = simulate(*scheme, *method, {.step = step, .duration = 0.5});
  INFO(solver << ": " << run.why);
  REQUIRE(run.status == Status::solved);
  CHECK(run.max_lcp_residual <= 1e-9);
  return place_of<Spatial>(run.final.q, 0);
}

}  // namespace

TEST_CASE(
    "pyramids: a block sent across a slope takes each pyramid's own path, which nears the disc's with the sides") {
  CrossSlope p;
  double last = kInf;
  for (const int sides : {4, 8, 16, 32, 64}) {
    CAPTURE(sides);
    double most = 0, coarse = 0, fine = 0;
    for (const double share : {0.05, 0.3, 0.55, 0.8}) {  // of the angle between two corners
      p.turn = share * 2 * std::numbers::pi / sides;
      const Vector3d disc = stop_on_slope(p)->place, exact = stop_on_slope(p, sides)->place;
      most = std::max(most, (exact - disc).norm());
      if (sides > 16) continue;
      const std::string solver = "lemke:facets=" + std::to_string(sides);
      coarse = std::max(coarse, (rests_at(p, solver, 1e-3) - exact).norm());
      fine = std::max(fine, (rests_at(p, solver, 2e-4) - exact).norm());
    }
    if (sides <= 16) {
      CHECK(coarse < 4e-3);
      CHECK(fine < coarse / 3);  // order 1
    }
    CHECK(most < 0.6 * last);
    CHECK(most > 1e-4 * 256 / (sides * sides));
    last = most;
  }
  p.turn = 0;
  CHECK((rests_at(p, "lemke", 2e-4) - stop_on_slope(p)->place).norm() <
        4e-4);  // pyramids that turn have the disc's answer
}

TEST_CASE("pyramids: every method of linear problems has the same path, in every scheme whose friction is a disc") {
  CrossSlope p;
  p.turn = 0.3;
  const Vector3d exact = rests_at(p, "lemke:facets=8", 1e-2);
  for (const char* solver :
       {"auto", "path", "newton-fb", "newton-min", "interior-point", "enumerate", "admm", "prox", "newton-ac"}) {
    CAPTURE(solver);
    CHECK((rests_at(p, std::string(solver) + ":facets=8", 1e-2) - exact).norm() < 1e-6);
  }
  for (const char* scheme : {"stewart-trinkle", "paoli-schatzman", "rattle", "generalized-alpha"}) {
    CAPTURE(scheme);
    const Vector3d bent = stop_on_slope(p, 4)->place, disc = stop_on_slope(p)->place;
    const Vector3d found = rests_at(p, "lemke:facets=4", 1e-3, scheme);
    CHECK((found - bent).norm() < 0.3 * (bent - disc).norm());
  }
}

TEST_CASE(
    "pyramids: the discs themselves are held by schemes that know the slip's direction, and sides are three or more") {
  const SpatialSystem system(cross_slope());
  const auto method = make_solver("lemke:facets=8");
  for (const char* scheme : {"event-driven", "adaptive", "anitescu-potra"}) {
    CAPTURE(scheme);
    const auto integrator = make_integrator(scheme, system);
    std::string words;
    try {
      simulate(*integrator, *method, {.step = 1e-2, .duration = 0.1});
    } catch (const std::invalid_argument& error) {
      words = error.what();
    }
    CHECK(words.starts_with("solver option facets = 8: must be 0 with integrator " + std::string(scheme)));
  }
  CHECK_THROWS_WITH(make_solver("lemke:facets=2"), "option facets = 2: must be 0 (discs) or in [3, 1024]");
  CHECK_THROWS_WITH(make_solver("prox:facets=-1"), "option facets = -1: must be in [0, 1024]");
  CHECK_THROWS_WITH(make_solver("path:facets=many"), "option facets = 'many': must be a whole number");
}

TEST_CASE("pyramids: sweeps and gradients, which need a positive diagonal or symmetry, end the run with that reason") {
  const SpatialSystem system(cross_slope());
  for (const char* name : {"pgs", "psor", "sgs", "jacobi", "nncg", "mprgp", "apgd"}) {
    CAPTURE(name);
    const auto integrator = make_integrator("moreau-jean", system);
    const auto method = make_solver(std::string(name) + ":facets=4");
    const Run run = simulate(*integrator, *method, {.step = 1e-2, .duration = 0.1});
    CHECK(run.status == Status::unsupported);
    const std::string refusal = method->refusal(integrator->problem());
    CHECK(!refusal.empty());
    CHECK(run.why.ends_with("; the solver cannot take it: " + refusal));
  }
}
