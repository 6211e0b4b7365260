// Memory of a pile in space: bytes a body and a contact, of the heap, after a step.
#include <doctest/doctest.h>
#include <malloc.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include "tests/support/sanitized.h"

using namespace orthant;

namespace {

double heap_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

}  // namespace

TEST_CASE("a pile's memory: laws once a collision set, and a bounded number of bytes a body and a contact") {
  if (kSanitized) return;  // another allocator
  constexpr int kBodies = 12000;
  const double before = heap_in_use();
  const SystemOf<Spatial> system(pour({.count = kBodies, .apart = 1, .spread = 0}));
  const double of_system = heap_in_use() - before;
  CHECK(of_system / kBodies < 900);  // [B] a law for each of eight places would add 1400
  const auto integrator = make_integrator("moreau-jean", system);
  const auto solver = make_solver("nncg:tolerance=0.3");
  State x = system.initial_state();
  const StepReport report = integrator->step(1e-3, *solver, x);
  REQUIRE(report.status == Status::solved);
  const double contacts = report.lcp_rows / 3.0;
  REQUIRE(contacts > 5 * kBodies);
  const double bytes = (heap_in_use() - before) / contacts;
  MESSAGE((of_system / kBodies), " B a body in the system; in all ", bytes, " B a contact, ", (contacts / kBodies),
          " contacts a body");
  CHECK(bytes < 2700);  // places that are reserved and not used included
}

TEST_CASE("a pile's sweeps: eight times the spheres, twice the height, and not much more than twice the sweeps") {
  const auto sweeps = [](int count) {
    const SystemOf<Spatial> system(pour({.count = count, .apart = 1, .spread = 0}));
    const auto integrator = make_integrator("moreau-jean", system);
    const auto solver = make_solver("nncg:tolerance=1e-4");
    State x = system.initial_state();
    const StepReport report = integrator->step(1e-3, *solver, x);
    REQUIRE(report.status == Status::solved);
    return static_cast<double>(report.lcp_iterations);
  };
  const double few = sweeps(250), many = sweeps(2000);
  MESSAGE("sweeps of 250 spheres: ", few, ", of 2000: ", many);
  CHECK(many < 3 * few);  // the contacts are nine times as many
}
