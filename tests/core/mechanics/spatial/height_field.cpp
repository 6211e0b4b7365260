// Height fields: prisms of a grid, as a scene file gives it; mistakes are named by key and rule.
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/height_field.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

using namespace orthant;

namespace {

std::string scene_with(const std::string& terrain) {
  return "dimension = 3\n[[body]]\nname = \"ball\"\nmass = 1\ninertia = 0.1\n[[collision]]\nshapes = [{body = "
         "\"ball\", radius = 0.1}, {body = \"ground\", " +
         terrain + "}]\n";
}

}  // namespace

TEST_CASE("a height field has two prisms for each cell, between the terrain and its depth") {
  const std::string terrain = "heights = [[0, 1, 2], [3, 4, 5]], spacing = [0.5, 2], origin = [1, -1, 10], depth = 3";
  const auto scene = std::get<spatial::Scene>(parse_any_scene(scene_with(terrain)));
  const auto& shapes = scene.collisions.at(0).shapes;
  REQUIRE(shapes.size() == 1 + 2 * 2);
  const auto has = [&](std::size_t prism, const Vector3d& corner) {
    const auto& corners = shapes[prism].corners;
    return std::find(corners.begin(), corners.end(), corner) != corners.end();
  };
  for (const std::size_t prism : {1U, 2U}) {
    CHECK(shapes[prism].corners.size() == 6);
    CHECK(has(prism, {1, -1, 10}));   // heights[0][0]
    CHECK(has(prism, {1.5, 1, 14}));  // heights[1][1]
    CHECK(has(prism, {1.5, 1, 10 - 3}));
  }
  CHECK(has(1, {1.5, -1, 13}));  // heights[1][0]
  CHECK(has(2, {1, 1, 11}));     // heights[0][1]
  CHECK(has(4, {1, 3, 12}));     // heights[0][2]
}

TEST_CASE("wrong height fields are refused by key and rule") {
  const auto refused = [](const std::string& terrain, const char* words) {
    CHECK_THROWS_WITH_AS(parse_any_scene(scene_with(terrain)), doctest::Contains(words), std::invalid_argument);
  };
  refused("heights = 1", "shapes[1].heights = 1: must be a list of lists of numbers");
  refused("heights = [[0, 1]]", "rows of the same length, at least 2 × 2 numbers");
  refused("heights = [[0, 1], [2]]", "rows of the same length, at least 2 × 2 numbers");
  refused("heights = [[0, 1], [2, 'a']]", "heights = 'a': must be a number");
  refused("heights = [[0, 1], [2, inf]]", "must be finite");
  refused("heights = [[0, 1], [2, 3]], spacing = [1, 0]", "spacing = [1, 0]: must be two lengths > 0");
  refused("heights = [[0, 1], [2, 3]], depth = 0", "depth = 0: must be > 0");
  const char* volume = "1e8 times the least of spacing and depth";
  for (const std::string wrong : {"1e+300", "-1e+300", "1e+09"}) {
    refused("heights = [[0, 1], [2, " + wrong + "]]", ("shapes[1].heights = " + wrong).c_str());
    refused("heights = [[0, 1], [2, " + wrong + "]]", volume);
  }
  refused("heights = [[0, 1], [2, 3]], spacing = [1e300, 1]",
          "spacing = [1e+300, 1]: must be at most 1e+08 m, 1e8 times");
  refused("heights = [[0, 1], [2, 3]], spacing = [1e-300, 1]", "spacing = [1e-300, 1]: must be at most 1e-292 m");
  refused("heights = [[0, 1], [2, 3]], depth = 1e9", "depth = 1e+09: must be at most 1e+08 m");
  refused("heights = [[0, 1], [2, 3]], origin = [0, 1e300, 0]", "origin = [0, 1e+300, 0]: must be at most 1e+08 m");
  refused("heights = [[0, 1e300], [2, 3]], spacing = [1e300, 1e300], depth = 1e300", "must be at most 1e+60 m");
  refused("spacing = [1, 1]", "missing key \"shapes[1].heights\"");
  refused("heights = [[0, 1], [2, 3]], radius = 1", "unknown key \"shapes[1].radius\"");
}
