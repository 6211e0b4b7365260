// Loads that rigid bodies leave open: a box on four corners shares its weight equally, and says where friction depends
// on it.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <cmath>
#include <string>

using namespace orthant;

namespace {

constexpr std::string_view kEventDriven[] = {"event-driven", "adaptive"};

/// On the floor, or above it; yaw [rad/s], and the velocity across [m/s].
SpatialSystem sliding_box(double yaw, double across, double height = 0) {
  const std::string text =
      "dimension = 3\ngravity = [0, 0, -9.81]\n[[body]]\nname = 'box'\nmass = 1.3\nsolid = {box = [0.24, 0.2, "
      "0.1]}\nposition = [0, 0, " +
      std::to_string(0.05 + height) + "]\nvelocity = [1.5, " + std::to_string(across) + ", 0]\nomega = [0, 0, " +
      std::to_string(yaw) +
      "]\n[[contact]]\nname = 'floor'\ntype = 'box-wall'\nbody = 'box'\nsize = [0.24, 0.2, 0.1]\nmu = 0.3\n"
      "wall = {body = 'ground', point = [0, 0, 0], normal = [0, 0, 1]}\n";
  return SpatialSystem(std::get<spatial::Scene>(parse_any_scene(text, {}, "box.toml")));
}

Run slide(const SpatialSystem& system, std::string_view integrator) {
  return run_in_space(system, integrator, 0.01, 0.2);
}

}  // namespace

TEST_CASE("a box that slides and yaws on four corners: its mirror image moves as its mirror image") {
  for (const std::string_view integrator : kEventDriven) {
    CAPTURE(integrator);
    for (const double height : {0.0, 0.05}) {  // 0.05: all corners strike at once, with slips of their own
      CAPTURE(height);
      const Run one = slide(sliding_box(4, 0.3, height), integrator),
                other = slide(sliding_box(-4, -0.3, height), integrator);
      CHECK(std::abs(one.final.q[0] - other.final.q[0]) < 1e-9);
      CHECK(std::abs(one.final.q[1] + other.final.q[1]) < 1e-9);
      CHECK(std::abs(one.final.v[5] + other.final.v[5]) < 1e-8);
      CHECK(one.final.v[5] < 3.7);  // it has slowed down
    }
  }
}

TEST_CASE("friction that depends on how four corners share a load is reported; that of a box without yaw does not") {
  for (const std::string_view integrator : kEventDriven) {
    CAPTURE(integrator);
    const Run yawing = slide(sliding_box(4, 0.3), integrator);
    CHECK(yawing.undetermined_steps > 0);
    CHECK(yawing.first_undetermined_time <= 0.1);  // end of the inner step, or after it
    const Run straight = slide(sliding_box(0, 0.3), integrator);
    CHECK(straight.undetermined_steps == 0);
    CHECK(straight.first_undetermined_time == kInf);
  }
}
