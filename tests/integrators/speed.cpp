// Speed: times as ratios to a fixed kernel in the same run, never by the clock alone. What a busy machine hides
// from these, tests/instructions counts.
#include <doctest/doctest.h>

#include <map>

#include "experiments/support/reference_kernel.h"
#include "tests/support/work.h"

using namespace orthant;

TEST_SUITE("slow") {  // not where sanitizers or missing optimization decide what is slow
  TEST_CASE("speed: a step, a link of a chain, a small problem and a pivot cost what they did") {
#ifdef NDEBUG
    // Units of the kernel, the most of two kinds of processor; beyond 1.6 times that something is lost.
    const std::map<std::string, double> measured{{"slider_crank", 0.24}, {"chain", 14},         {"pile", 4.7},
                                                 {"spd_10", 0.2},        {"friction_12", 0.66}, {"spd_100", 62},
                                                 {"ties_400", 2200}};
    for (const Work& work : watched_work()) {
      if (!measured.contains(work.name)) continue;  // counted only
      const auto run = work.make();
      const double cost = units(15, [&] { run(work.least); }) / static_cast<double>(work.least);
      INFO(work.name, ": units a ", work.unit, ": ", cost);
      CHECK(cost < 1.6 * measured.at(work.name));
    }
#endif
  }
}
