// Memory of a pile in space: bytes a body and a contact, of the heap, after a step.
#include <doctest/doctest.h>
#include <malloc.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <algorithm>

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
  CHECK(of_system / kBodies < 1300);  // [B] with a law for each place of a pair it is 2700
  const auto integrator = make_integrator("moreau-jean", system);
  const auto solver = make_solver("nncg:tolerance=0.3");
  State x = system.initial_state();
  REQUIRE(integrator->step(1e-3, *solver, x).status == Status::solved);
  const auto contacts =
      std::ranges::count_if(integrator->impulses(), [](const auto& impulse) { return impulse.normal > 0; });
  REQUIRE(contacts > 5 * kBodies);
  const double bytes = (heap_in_use() - before) / static_cast<double>(contacts);
  MESSAGE(of_system / kBodies, " B a body in the system; in all ", bytes, " B a contact, ",
          static_cast<double>(contacts) / kBodies, " contacts a body");
  CHECK(bytes < 3000);
}
