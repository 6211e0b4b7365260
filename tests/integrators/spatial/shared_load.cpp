// Loads that rigid bodies leave open: a box on four corners shares its weight equally, and says where friction depends
// on it.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

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

TEST_CASE(
    "feet of a door that static friction lets go one after the other all slide: the turn after the impact is exact") {
  // All slide along the circle: Δω = −μ Σ N R / J, J (1 + …) by the cylindrical joint; N = m (1 + e) v.
  const auto door = [](bool reversed) {
    std::string text =
        "dimension = 3\ngravity = [0, 0, -9.81]\n[[body]]\nname = 'b'\nmass = 1\ninertia = [0.02, 0.02, 0.03]\n"
        "position = [0, 0, 0.101]\nvelocity = [0, 0, -1]\nomega = [0, 0, 4]\n[[joint]]\nname = 'pivot'\n"
        "type = 'cylindrical'\nbodies = ['ground', 'b']\npoint_a = [0, 0, 0]\npoint_b = [0, 0, 0]\n"
        "axis = [0, 0, 1]\n";
    for (int i = 0; i < 5; ++i) {
      const int k = reversed ? 4 - i : i;
      const double angle = 0.3 + 1.1 * k;
      text += "[[contact]]\nname = 'foot" + std::to_string(k) + "'\ntype = 'corner-wall'\nbody = 'b'\npoint = [" +
              std::to_string(0.2 * std::cos(angle)) + ", " + std::to_string(0.2 * std::sin(angle)) +
              ", -0.1]\nwall = {body = 'ground', point = [0, 0, 0], normal = [0, 0, 1]}\nmu = 0.1\nmu_static = "
              "0.9\ne_n = 0.5\n";
    }
    return SpatialSystem(std::get<spatial::Scene>(parse_any_scene(text, {}, "door.toml")));
  };
  for (const std::string_view integrator : kEventDriven) {
    CAPTURE(integrator);
    const Run run = run_in_space(door(false), integrator, 0.005, 0.01),
              other = run_in_space(door(true), integrator, 0.005, 0.01);
    const double v = std::sqrt(1 + 2 * 9.81 * 0.001), turn = 4 - 0.1 * 1.5 * v * 0.2 / 0.03;
    CHECK(run.final.v[5] == doctest::Approx(turn).epsilon(1e-6));
    CHECK(std::abs(run.final.v[5] - other.final.v[5]) < 1e-10);
  }
}

TEST_CASE("adaptive in space: an impact at the start belongs to the first row") {
  const std::string text =
      "dimension = 3\ngravity = [0, 0, -9.81]\n[[body]]\nname = 'b'\nmass = 1\ninertia = [0.02, 0.02, 0.03]\n"
      "position = [0, 0, 0]\nvelocity = [0, 0, -1]\n[[contact]]\nname = 'corner'\ntype = 'corner-wall'\n"
      "body = 'b'\npoint = [0, 0, 0]\nwall = {body = 'ground', point = [0, 0, 0], normal = [0, 0, 1]}\ne_n = 0.9\n";
  const SpatialSystem system(std::get<spatial::Scene>(parse_any_scene(text, {}, "corner.toml")));
  for (const std::string_view integrator : kEventDriven) {
    CAPTURE(integrator);
    std::vector<double> rows;
    run_in_space(system, integrator, 0.01, 0.03,
                 [&](const SpatialSample& sample) { rows.push_back(sample.impulses[0].normal); });
    REQUIRE(rows.size() >= 2);
    CHECK(rows[rows.size() - 3] == doctest::Approx(1.9).epsilon(1e-9));
    CHECK(rows.back() == 0);
  }
}
