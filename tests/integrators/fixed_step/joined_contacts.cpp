// Contacts that only the impulses of others close within a step: which ones join does not depend on the frame.
#include "experiments/studies/motion_storm/twin.h"
#include "tests/support/runs.h"

#include <doctest/doctest.h>

using namespace orthant;

TEST_CASE("a disc that is struck towards a floor meets it in the same step, in frames that are turned alike") {
  const double h = 1e-2, drop = 1;
  for (const std::string scheme : {"stewart-trinkle", "paoli-schatzman", "anitescu-potra"})
    for (const double open : {0.5, 1.0, 1.5}) {  // of the way of the heavy disc in a step
      Scene s{.duration = 2 * h};
      const BodyId heavy = s.body({.mass = 100, .inertia = 1, .velocity = {10, -drop}}),
                   light = s.body({.mass = 0.01, .inertia = 1e-5, .velocity = {10, 0}});
      s.bodies[static_cast<std::size_t>(light)].position = {0, 0.05 + open * drop * h};
      s.bodies[static_cast<std::size_t>(heavy)].position = {0, 0.2 + (open + 0.5) * drop * h};
      s.contact(DiscDisc{{}, heavy, {0, 0}, 0.1, light, {0, 0}, 0.05, {.e = 1}});
      s.contact(DiscWall{{}, light, {0, 0}, 0.05, kGround, {0, 0}, {0, 1}, {.e = 1}});
      CAPTURE(scheme);
      CAPTURE(open);
      const Run here = run(s, scheme, h);
      REQUIRE(here.status == Status::solved);
      CHECK(here.final.q[3 * light + 1] > 0.05 - drop * h);
      for (const double phi : {0.7, 1.5707963267948966, 2.5}) {
        CAPTURE(phi);
        const motion_storm::Twin turned{.name = "turned", .phi = phi};
        const Run there = run(motion_storm::twin_of(s, turned), scheme, h);
        CHECK((motion_storm::back(turned, there.final.q) - here.final.q).lpNorm<Eigen::Infinity>() < 1e-10);
      }
    }
}
