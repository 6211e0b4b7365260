// Scenes from files: the same data as from C++, what is left out, what is overridden; nothing crashes.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/support/spline.h>

#include <cctype>
#include <cmath>

#include "tests/core/mechanics/scene_dump.h"
#include "tests/core/mechanics/scene_examples.h"
#include "tests/support/runs.h"
#include "tests/support/scene_texts.h"

namespace orthant {

using namespace scene_texts;

TEST_CASE("slider_crank.toml is slider_crank(), bit for bit") {
  const Scene from_file = read_scene(kCore / "scenes" / "slider_crank.toml");
  CHECK(dump(from_file) == dump(slider_crank()));
  CHECK(dump(from_file) != dump(slider_crank({.mu = std::nextafter(0.01, 1)})));  // the dump sees the last bit
}

TEST_CASE("a guide is the slider-crank's four corners, bit for bit") {
  Scene expected = slider_crank();
  for (std::size_t i = 0; i < 4; ++i)
    std::get<CornerWall>(expected.contacts[i]).name = "guide_" + std::to_string(i + 1);
  CHECK(dump(read_scene(kCore / "scenes" / "slider_crank_guide.toml")) == dump(expected));
}

// One text with every key, and the scene that it must give, side by side.
TEST_CASE("every element and key arrives where it belongs") {
  const Scene scene = parse_scene(R"(
    gravity = [0.5, -2]
    duration = 3
    step = 0.25
    restitution = "poisson"
    impacts = "sequential"
    [[contact]]            # before the bodies: the order of the kinds is free
    type = "disc-wall"
    body = "ball"
    centre = [1, 2]
    radius = 3
    wall = {body = "rod", point = [4, 5], normal = [3, 4]}
    mu = 0.1
    e_n = 0.2
    e_t = 0.3
    [[body]]
    name = "rod"
    mass = 1
    inertia = 2
    [[body]]
    name = "ball"
    mass = 3
    inertia = 4
    position = [5, 6]
    angle = 7
    velocity = [8, 9]
    omega = 10
    [[contact]]
    name = "two"
    type = "disc-disc"
    bodies = ["rod", "ball"]
    centre_a = [1, 2]
    centre_b = [3, 4]
    radius_a = 5
    radius_b = 6
    [[contact]]
    type = "corner-wall"
    body = "rod"
    point = [1, 2]
    wall = {normal = [0, -7]}
    [[joint]]
    type = "prismatic"
    bodies = ["rod", "ball"]
    point_a = [1, 2]
    point_b = [3, 4]
    axis = [0, 2]
    angle = 5
    [[spring]]
    type = "point"
    bodies = ["ground", "rod"]
    point_a = [1, 2]
    point_b = [3, 4]
    stiffness = 5
    damping = 6
    rest = 7
    [[spring]]
    type = "torsion"
    bodies = ["ball", "ground"]
    stiffness = 5
    damping = 6
    rest = -7
    [[joint]]
    name = "pin"
    type = "revolute"
    bodies = ["ground", "rod"]
    [[joint]]
    type = "drive"
    joint = "pin"
    offset = 1
    rate = 2
    amplitude = 3
    omega = 4
    phase = 5
    table = {times = [0, 1], values = [6, 7]}
    [[joint]]
    type = "drive"
    of = "distance"
    bodies = ["rod", "ball"]
    point_a = [1, 2]
    point_b = [3, 4]
    rate = 0.5
    offset = 0
    [[contact]]
    name = "stop"
    type = "limit"
    joint = "joint1"
    lower = -1
    upper = 2
    e_n = 0.5
    [[contact]]
    type = "rope"
    bodies = ["rod", "ball"]
    point_a = [1, 2]
    point_b = [3, 4]
    length = 5
    [[contact]]
    name = "box"
    type = "polygon-wall"
    body = "rod"
    corners = [[0, 0], [1, 0], [0, 1]]
    wall = {body = "ball", point = [1, 2], normal = [0, 1]}
    mu = 0.5
    [[contact]]
    name = "two_boxes"
    type = "polygon-polygon"
    bodies = ["rod", "ball"]
    corners_a = [[0, 0], [1, 0], [0, 1]]
    corners_b = [[0, 0], [2, 0], [0, 2]]
    [[contact]]
    type = "disc-polygon"
    bodies = ["rod", "ball"]
    centre = [1, 2]
    radius = 3
    corners = [[0, 0], [2, 0], [0, 2]]
    [[contact]]
    type = "journal"
    bodies = ["rod", "ball"]
    centre_a = [1, 2]
    centre_b = [3, 4]
    radius_a = 5
    radius_b = 16
    mu_static = 0.7
    [[friction]]
    of = "slide"
    bodies = ["rod", "ball"]
    point_a = [1, 2]
    point_b = [3, 4]
    axis = [0, 3]
    bound = 5
    [[spring]]
    type = "joint"
    joint = "pin"
    stiffness = 5
    damping = 6
    rest = 7
    [[load]]
    body = "ball"
    point = [1, 2]
    force = [3, 4]
    torque = 5
    factor = {type = "cosine", amplitude = 2, omega = 3, phase = 4}
    [[load]]
    body = "rod"
    factor = {type = "table", times = [0, 1, 3], values = [2, 4, 0]}
  )");
  Scene expected{.gravity = {0.5, -2},
                 .restitution = Restitution::poisson,
                 .impacts = Impacts::sequential,
                 .duration = 3,
                 .step = 0.25};
  expected.body({"rod", 1, 2});
  expected.body({"ball", 3, 4, {5, 6}, 7, {8, 9}, 10});
  expected.contact(DiscWall{"", 1, {1, 2}, 3, 0, {4, 5}, {0.6, 0.8}, {0.1, 0.2, 0.3}});
  expected.contact(DiscDisc{"two", 0, {1, 2}, 5, 1, {3, 4}, 6, {}});
  expected.contact(CornerWall{"", 0, {1, 2}, kGround, {0, 0}, {0, -1}, {}});
  expected.joint(Prismatic{"", 0, 1, {1, 2}, {3, 4}, {0, 1}, 5});
  expected.spring(PointSpring{"", kGround, 0, {1, 2}, {3, 4}, 5, 6, 7});
  expected.spring(TorsionSpring{"", 1, kGround, 5, 6, -7});
  expected.joint(Revolute{"pin", kGround, 0});
  expected.joint(Drive{"", Angle{kGround, 0}, {1, 2, 3, 4, 5, Spline({0, 1}, {6, 7})}});
  expected.joint(Drive{"", Span{0, 1, {1, 2}, {3, 4}}, {.rate_of_change = 0.5}});
  const Slide rail{0, 1, {1, 2}, {3, 4}, {0, 1}};
  expected.contact(Limit{"stop_lower", rail, Limit::Side::lower, -1, {.e = 0.5}});
  expected.contact(Limit{"stop_upper", rail, Limit::Side::upper, 2, {.e = 0.5}});
  expected.contact(Limit{"contact5", Span{0, 1, {1, 2}, {3, 4}}, Limit::Side::upper, 5, {}});
  const Polygon small{{0, 0}, {1, 0}, {0, 1}}, large{{0, 0}, {2, 0}, {0, 2}};
  for (int i = 0; i < 3; ++i)
    expected.contact(CornerWall{
        "box_" + std::to_string(i + 1), 0, small[static_cast<std::size_t>(i)], 1, {1, 2}, {0, 1}, {.mu = 0.5}});
  expected.contact(PolygonPolygon{"two_boxes_1", 0, small, 1, large, 0, {}});
  expected.contact(PolygonPolygon{"two_boxes_2", 0, small, 1, large, 1, {}});
  expected.contact(DiscPolygon{"contact8", 0, {1, 2}, 3, 1, large, {}});
  expected.contact(Journal{"contact9", 0, {1, 2}, 5, 1, {3, 4}, 16, {.mu_static = 0.7}});
  expected.friction({"", rail, 5});
  expected.spring(JointSpring{"", Angle{kGround, 0}, 5, 6, 7});
  expected.load({"", 1, {1, 2}, {3, 4}, 5, [](double t) { return 2 * std::cos(3 * t + 4); }});
  expected.load({"", 0, {0, 0}, {0, 0}, 0, [](double t) {
                   return t < 0 ? 2.0 : t < 1 ? 2 + 2 * t : t < 3 ? 6 - 2 * t : 0;
                 }});
  // The table's values are compared to rounding, everything else by its bits.
  for (const double t : {-1.0, 0.0, 0.3, 1.0, 2.5, 3.0, 9.0})
    CHECK(scene.loads[1].factor(t) == doctest::Approx(expected.loads[1].factor(t)).epsilon(1e-15));
  expected.loads[1].factor = scene.loads[1].factor;
  CHECK(dump(scene) == dump(expected));
}

TEST_CASE("angles, lengths and rests that are left out are those of the initial pose") {
  const Scene scene = parse_scene(kBodies + R"(
    [[joint]]
    type = "prismatic"
    bodies = ["ball", "cart"]
    [[joint]]
    type = "fixed"
    bodies = ["ball", "cart"]
    [[joint]]
    type = "distance"
    bodies = ["ground", "cart"]
    [[spring]]
    type = "point"
    bodies = ["ground", "cart"]
    point_a = [3, 0]
    [[spring]]
    type = "torsion"
    bodies = ["cart", "rod"]
    [[spring]]
    type = "joint"
    joint = "joint1"
    [[joint]]
    type = "drive"
    joint = "joint1"
    amplitude = 2
    phase = 1
  )");
  CHECK(std::get<JointSpring>(scene.springs[2]).rest == 3);
  CHECK(std::get<Drive>(scene.joints[3]).law.value(0) == 3);
  CHECK(std::get<Prismatic>(scene.joints[0]).angle == 0.5);
  CHECK(std::get<Fixed>(scene.joints[1]).angle == -0.5);
  CHECK(std::get<Distance>(scene.joints[2]).length == 5);
  CHECK(std::get<PointSpring>(scene.springs[0]).rest == 4);
  CHECK(std::get<TorsionSpring>(scene.springs[1]).rest == 0.5);
}

TEST_CASE("a contact without a name is known by its place in the file, however many it stands for") {
  const std::string wall =
      "[[contact]]\ntype = \"polygon-wall\"\nbody = \"rod\"\nwall = {normal = [0, 1]}\n"
      "corners = [[0, 0], [1, 0], [0, 1]]\n";
  const Scene scene = parse_scene(kBodies + wall + wall, Strings{"contact.contact2.mu=0.5"});
  REQUIRE(scene.contacts.size() == 6);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& corner = std::get<CornerWall>(scene.contacts[i]);
    CHECK(corner.name == (i < 3 ? "contact1_" : "contact2_") + std::to_string(i % 3 + 1));
    CHECK(corner.law.mu == (i < 3 ? 0 : 0.5));
  }
}

TEST_CASE("the factor of a load follows a table in straight lines, or the cubic spline through its points") {
  const auto factor = [](const char* type, const std::string& more) {
    const std::string load =
        "[[load]]\nbody = 'a'\nfactor = {type = '" + std::string(type) + "', times = [0, 1, 3], values = [0, 2, -1]}\n";
    const std::string body = more + "[[body]]\nname = 'a'\nmass = 1\ninertia = 1\n";
    const AnyScene any = parse_any_scene(body + load, {}, "s.toml");
    return std::visit([](const auto& scene) { return scene.loads.at(0).factor; }, any);
  };
  const Spline spline({0, 1, 3}, {0, 2, -1});
  for (const std::string more : {"", "dimension = 3\n"}) {
    CHECK(factor("table", more)(0.25) == 0.5);
    for (const double t : {-1.0, 0.0, 0.25, 1.0, 1.7, 3.0, 4.0}) CHECK(factor("spline", more)(t) == spline.value(t));
    CHECK(std::abs(factor("spline", more)(0.25) - 0.5) > 0.1);  // it begins with slope 0
  }
}

}  // namespace orthant
