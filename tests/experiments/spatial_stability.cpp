// How far numbers carry in space: masses, inertias, spins, clearances, distances against exact motions.
#include "experiments/studies/support/spatial_stability.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <string_view>

using namespace orthant;

namespace {

SpatialTrialResult carried(std::string_view study, double value, const std::string& integrator) {
  const auto all = spatial_studies(true);
  const auto found = std::ranges::find(all, study, &SpatialStudy::name);
  REQUIRE(found != all.end());
  return run_trial(found->trial(value), integrator, 60);
}

}  // namespace

TEST_CASE(
    "in space ratios of 1e6, spins of 1e6 rad/s, clearances of 1e-7 m and places 1000 km away have exact motions") {
  struct {
    const char *study, *integrator;
    double value, error;
  } const all[] = {
      {"mass ratio", "moreau-jean", 1e6, 1e-9},   {"mass ratio", "event-driven", 1e6, 1e-9},
      {"load ratio", "moreau-jean", 1e6, 1e-9},   {"load ratio", "rattle", 1e6, 1e-9},
      {"needle", "moreau-jean", 1e6, 1e-3},       {"needle", "adaptive", 1e6, 1e-6},
      {"plate", "moreau-jean", 1e6, 1e-11},       {"plate", "adaptive", 1e6, 1e-7},
      {"spin [rad/s]", "moreau-jean", 1e6, 1e-4}, {"spin [rad/s]", "event-driven", 1e6, 1e-10},
      {"clearance [m]", "rattle", 1e-7, 1e-6},    {"clearance [m]", "event-driven", 1e-7, 1e-10},
      {"distance [m]", "moreau-jean", 1e6, 1e-6}, {"distance [m]", "adaptive", 1e6, 1e-6},
  };
  for (const auto& one : all) {
    CAPTURE(one.study);
    CAPTURE(one.integrator);
    const SpatialTrialResult r = carried(one.study, one.value, one.integrator);
    CHECK_MESSAGE(r.end == "solved", r.why);
    CHECK(r.error <= one.error);
  }
}
