// Collisions in motion: the answer of all pairs listed, by every stepper.
#include "tests/support/allocations.h"
#include "tests/support/runs.h"
#include "tests/support/spatial.h"

#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <malloc.h>

using namespace orthant;

namespace {

/// A heap of discs, triangles and boxes, some of them fast, over a ground with a peg.
Scene heap() {
  Scene s = pile({.discs = 12, .e = 0.3});
  auto& shapes = s.collisions[0].shapes;
  s.collisions[0].neighbours = 20;
  for (std::size_t i = 0; i < shapes.size(); i += 3) {
    const double r = 0.7 * shapes[i].radius;
    shapes[i].corners = i % 2 == 0 ? rectangle(2 * r, 1.5 * r) : Polygon{{-r, -r}, {r, -r}, {0, r}};
  }
  s.bodies[4].velocity = {3, -2}, s.bodies[9].omega = 30, s.bodies[11].velocity = {-8, -15};
  shapes.push_back({kGround, {0.15, 0.02}, 0.03, {}});
  return s;
}

constexpr const char* kSteppers[] = {"moreau-jean",     "stewart-trinkle",   "anitescu-potra",
                                     "paoli-schatzman", "generalized-alpha", "rattle"};

}  // namespace

TEST_CASE("a collision is all its pairs listed, to the bit") {
  for (const std::string integrator : kSteppers) {
    CAPTURE(integrator);
    const Scene scene = heap();
    const auto solver = integrator == "anitescu-potra" ? "lemke" : "auto";
    double impulse = 0, listed_impulse = 0;
    const auto sum_into = [](double& sum) {
      return [&sum](const RunSample& m) {
        for (const Impulse& p : m.impulses) sum += p.normal;
      };
    };
    const Run found = run(scene, integrator, 1e-3, sum_into(impulse), solver);
    const Run listed = run(with_pairs_listed(scene), integrator, 1e-3, sum_into(listed_impulse), solver);
    CAPTURE(found.why);
    CHECK(found.status == listed.status);
    CHECK(found.steps == listed.steps);
    CHECK(found.steps >=
          5);  // paoli-schatzman makes energy here, and is ended for it  // paoli-schatzman stops there, either way
    CHECK(found.final.q == listed.final.q);
    CHECK(found.lcp_iterations == listed.lcp_iterations);
    CHECK(impulse == doctest::Approx(listed_impulse).epsilon(1e-14));
    CHECK(impulse > 0);
  }
}

TEST_CASE("a step with more pairs than there is room for ends in words, the state as it was") {
  Scene scene = heap();
  scene.collisions[0].neighbours = 0.3;
  for (const char* integrator : kSteppers) {
    const Run r = run(scene, integrator, 1e-3);
    CHECK(r.status == Status::numerical_error);
    CHECK(r.why.find("neighbours = 0.3") != std::string::npos);
  }
}

TEST_CASE("collisions allocate nothing once the pile lies, and sleeping keeps each pair's force") {
  Scene scene = pile({.discs = 25});
  // A disc that comes by later makes the pairs be numbered again; it meets nobody.
  scene.collisions[0].shapes.insert(scene.collisions[0].shapes.begin(), {kGround, {-3, 3}, 0.05, {}});
  const auto passer = scene.body({.mass = 1e-3, .inertia = 1e-6, .position = {-6, 3.2}, .velocity = {3, 0}});
  scene.load({.name = "", .body = passer, .force = {0, 9.81e-3}});
  scene.collisions[0].shapes.push_back({passer, {0, 0}, 0.05, {}});
  for (const char* spec : {"moreau-jean", "moreau-jean:sleep_after=0.05,sleep_speed=1e-4"}) {
    const System system(scene);
    const auto scheme = make_integrator(spec, system);
    const auto solver = make_solver("pgs");
    State x = system.initial_state();
    std::vector<Impulse> lying;
    for (int k = 0; k < 1500; ++k) REQUIRE(scheme->step(1e-3, *solver, x).status == Status::solved);
    const auto before = AllocationCount::now();
    for (int k = 0; k < 200; ++k) scheme->step(1e-3, *solver, x);
    CHECK(AllocationCount::now() == before);
    CHECK(x.v.head(75).lpNorm<Eigen::Infinity>() < 1e-3);
    double floor = 0, weight = 0;
    for (std::size_t i = 0; i < 75; i += 3) floor += scheme->impulses()[i].normal;
    for (Index i = 1; i < 75; i += 3) weight -= system.weight()[i] * 1e-3;
    CHECK(floor <= weight * (1 + 1e-6));  // the walls bear some of it
    CHECK(floor > 0.5 * weight);
  }
}

namespace {

std::size_t bytes_in_use() {
  const auto heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

struct PourCost {
  double bytes = 0;        // a body, with its contacts
  double allocations = 0;  // a step, of the last ones
  double contacts = 0;     // a body
  int sweeps = 0;          // of the last step, warm and cold
  int cold_sweeps = 0;
};

/// A packing of spheres that settles for some steps.
PourCost poured(int count) {
  PourCost cost;
  const std::size_t before = bytes_in_use();
  const SpatialSystem system(pour({.count = count, .apart = 1.01, .spread = 0.01}));
  const auto scheme = make_integrator("moreau-jean", system);
  const auto solver = make_solver("psor:tolerance=1e-4");
  State x = system.initial_state();
  for (int k = 0; k < 60; ++k) REQUIRE(scheme->step(2e-3, *solver, x).status == Status::solved);
  const std::size_t allocations = AllocationCount::now();
  for (int k = 0; k < 10; ++k) REQUIRE(scheme->step(2e-3, *solver, x).status == Status::solved);
  cost.allocations = static_cast<double>(AllocationCount::now() - allocations) / 10;
  cost.bytes = static_cast<double>(bytes_in_use() - before) / count;
  cost.contacts = static_cast<double>(scheme->problem().friction.size()) / count;
  const auto fresh = make_integrator("moreau-jean", system);
  State same = x;
  cost.sweeps = scheme->step(2e-3, *solver, x).lcp_iterations;
  cost.cold_sweeps = fresh->step(2e-3, *solver, same).lcp_iterations;
  return cost;
}

}  // namespace

TEST_CASE(
    "memory and allocations of a pile grow no faster than its bodies, and a step starts from its contacts' impulses") {
  const PourCost few = poured(700), many = poured(2800);
  CAPTURE(few.contacts);
  CHECK(many.contacts > 2.5);
  CHECK(many.contacts == doctest::Approx(few.contacts).epsilon(0.3));
  MESSAGE("bytes a body ", few.bytes, " and ", many.bytes, ", allocations a step ", few.allocations, " and ",
          many.allocations, ", sweeps ", many.sweeps, ", from zero ", many.cold_sweeps);
  CHECK(many.bytes < 1.15 * few.bytes);
  CHECK(many.bytes < 14000);
  CHECK(many.allocations <= few.allocations + 20);
  CHECK(2 * many.sweeps <= many.cold_sweeps);
}
