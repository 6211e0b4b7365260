// Steps of adaptive and event-driven in space: where they once shrank without end (slip next to zero, pins in bushes),
// and landings that do not depend on the output step.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <string>

using namespace orthant;

namespace {

spatial::Scene counted_scene(const std::string& text) {
  return std::get<spatial::Scene>(parse_any_scene("dimension = 3\n" + text, {}, "scene.toml"));
}

/// Three feet of different friction, which skid round on the ground.
spatial::Scene skidding_tripod() {
  std::string text =
      "gravity = [0, 0, -9.81]\n[[body]]\nname = 't'\nmass = 1\ninertia = [0.02, 0.02, 0.03]\nposition = [0, 0, 0.05]\n"
      "velocity = [0.051248497209457025, 0.7456315092948199, 0]\nomega = [0, 0, 7.100094228785955]\n";
  const auto foot = [&](const std::string& point, const std::string& mu) {
    text += "[[contact]]\ntype = 'corner-wall'\nbody = 't'\npoint = [" + point + ", -0.05]\nmu = " + mu +
            "\nwall = {normal = [0, 0, 1]}\n";
  };
  foot("-0.1861273772983587, 0.0969149929427977", "0.1992189148193627");
  foot("-0.0011882816491819161, -0.19732643579781778", "0.3958707570795379");
  foot("0.11742928914326434, 0.08113587302950052", "0.11150932951817545");
  return counted_scene(text);
}

/// An arm on a pin in a bush with clearance, which falls into it and swings.
spatial::Scene bushed_arm(double mu) {
  return counted_scene(
      "gravity = [0, -9.81, 0]\n[[body]]\nname = 'arm'\nmass = 1\ninertia = [0.001, 0.02, 0.02]\n"
      "position = [0.25, 0, 0]\nomega = [0, 0, 4]\n[[contact]]\ntype = 'pin-bush'\nbodies = ['arm', 'ground']\n"
      "centre_a = [-0.25, 0, 0]\naxis = [0, 0, 1]\nradius_a = 0.02\nradius_b = 0.0205\nlength_a = 0.06\ne_n = 0.2\n"
      "mu = " +
      std::to_string(mu) + "\n");
}

}  // namespace

TEST_CASE("feet that skid to a stop one after the other cost some tens of steps, and both integrators agree") {
  const SpatialSystem system(skidding_tripod());
  State final[2];
  for (const int i : {0, 1}) {
    CAPTURE(i);
    const Run run = run_in_space(system, i == 0 ? "adaptive" : "event-driven", 0.05, 1);
    INFO(run.why);
    REQUIRE(run.status == Status::solved);
    CHECK(run.accepted + run.rejected < 1000);
    final[i] = run.final;
  }
  CHECK((final[0].q - final[1].q).lpNorm<Eigen::Infinity>() < 1e-6);
}

TEST_CASE("a pin that rolls round in its bush costs no more steps than its bounces do, with and without friction") {
  for (const double mu : {0.0, 0.1}) {
    CAPTURE(mu);
    const SpatialSystem system(bushed_arm(mu));
    for (const std::string_view integrator : {"adaptive", "event-driven"}) {
      CAPTURE(integrator);
      const Run run = run_in_space(system, integrator, 0.02, 0.2);
      INFO(run.why);
      REQUIRE(run.status == Status::solved);
      CHECK(run.accepted + run.rejected < 3000);
      CHECK(run.crossings == 0);
    }
  }
}

TEST_CASE("event-driven lands a ball at the same place whatever the output step") {
  const SpatialSystem system(std::get<spatial::Scene>(
      read_any_scene(ORTHANT_TEST_DATA "/billiards_landing.toml", std::vector<std::string>{})));
  State first;
  for (int i = 0; i < 60; ++i) {
    const double step = 0.01 + 0.005 * i + 0.00013 * (i % 7);
    CAPTURE(step);
    const Run run = run_in_space(system, "event-driven", step, system.scene().duration);
    if (i == 0) first = run.final;
    CHECK((run.final.q - first.q).lpNorm<Eigen::Infinity>() < 1e-6);
  }
}
