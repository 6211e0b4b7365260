// A known limit with its figure: what starts to slide leaves the surface under anitescu-potra, whatever the step.
#include <orthant/core/mechanics/scene/scene_toml.h>

#include "tests/support/runs.h"
#include "tests/support/scene_texts.h"

using namespace orthant;

TEST_CASE("anitescu-potra: the hop at a sliding start is (mu v / (1 + mu^2))^2 / (2 g), and no other scheme has it") {
  for (const double mu : {0.25, 0.1}) {
    const scene_texts::Strings overrides{"contact.floor.mu=" + std::to_string(mu), "duration=0.2"};
    const Scene scene = read_scene(scene_texts::kCore / "scenes" / "sliding_box.toml", overrides);
    const auto hop = [&](std::string_view integrator, double h) {
      double most = 0;
      const Run r =
          run(scene, integrator, h, [&](const RunSample& moment) { most = std::max(most, moment.state.q[1]); });
      REQUIRE(r.status == Status::solved);
      return most - 0.1;
    };
    const double theory = std::pow(mu / (1 + mu * mu), 2) / (2 * 9.81);
    CHECK(std::abs(hop("anitescu-potra", 1e-4) - theory) < 0.02 * theory);
    CHECK(std::abs(hop("anitescu-potra", 2e-5) - theory) < 0.01 * theory);
    for (const char* integrator : {"moreau-jean", "stewart-trinkle", "rattle", "generalized-alpha"})
      CHECK(hop(integrator, 1e-4) < 1e-7);
  }
}
