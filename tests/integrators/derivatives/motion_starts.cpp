// Derivatives of event-driven motions whose start has closed contacts: the side that they are of, or none.
#include <doctest/doctest.h>

#include "tests/integrators/derivatives/motion_trials.h"

#include <string>

using namespace orthant;

TEST_CASE("tangent of a motion: starts whose sides differ are named, with the side, or have none") {
  const std::string box = R"(
[[body]]
name = "b"
mass = 1
inertia = 0.02
position = [0, 0.15]
[[contact]]
name = "c"
type = "corner-wall"
body = "b"
point = [-0.2, -0.15]
wall = {normal = [0, 1]}
mu = 0.4
[[contact]]
name = "d"
type = "corner-wall"
body = "b"
point = [0.2, -0.15]
wall = {normal = [0, 1]}
mu = 0.4
)";
  const auto solver = make_solver("auto");
  const auto of = [&](const std::string& gravity, const MotionTrial& trial) {
    const std::string text = gravity + box;
    return differentiate_motion(System(from_text(text)({})), parameters_of(text, {trial}), {}, *solver, 0.1);
  };
  const std::string level = "gravity = [0, -9.81]\n", holds = "gravity = [2, -9.81]\n",
                    slides = "gravity = [6, -9.81]\n";
  const MotionTrial height{"body.b.position", "[0, ", "]", 0.15}, push{"body.b.velocity", "[", ", 0]", 0};
  for (const std::string& gravity : {level, holds, slides})
    CHECK(of(gravity, {"body.b.angle", "", "", 0}).none.find("overlaps on either side") != std::string::npos);
  const auto warns = [&](const MotionTangent& t, const char* words) {
    REQUIRE(t.warnings.size() == 1);
    CHECK(t.none == "");
    CHECK(t.warnings[0].find(words) != std::string::npos);
  };
  warns(of(holds, height), "of smaller values, where they stay closed");
  warns(of(slides, height), "of larger values, where a short flight closes them again");
  warns(of(slides, push), "begin to slide at the start ('c', 'd'): the derivative is one-sided, of larger values");
  CHECK(of(slides, {"body.b.omega", "", "", 0}).none.find("on either side of the value") != std::string::npos);
  const MotionTrial corner{"contact.d.point", "[0.2, ", "]", -0.15};  // its fall tilts the box, which turns its slips
  CHECK(of(slides, corner).none.find("square root of the change") != std::string::npos);
  CHECK(of(holds, corner).none == "");
  CHECK(of(level, push).warnings.empty());
  CHECK(of(holds, push).warnings.empty());
  const std::string damper =
      "[[spring]]\ntype = \"joint\"\nof = \"slide\"\nbodies = [\"ground\", \"b\"]\naxis = [1, 0]\ndamping = 2\n";
  CHECK(of(slides + damper, height).none.find("dampers act") != std::string::npos);
  CHECK(of(slides + damper, push).none == "");
}

TEST_CASE("tangent of a motion: falls that turn a body, and contacts of which not all stay closed, are refused") {
  const auto solver = make_solver("auto");
  const auto none_of = [&](const std::string& text, const MotionTrial& trial, double duration) {
    return differentiate_motion(System(from_text(text)({})), parameters_of(text, {trial}), {}, *solver, duration).none;
  };
  const auto corner = [](const std::string& name, double x, const std::string& more) {
    return "[[contact]]\nname = \"" + name + "\"\ntype = \"corner-wall\"\nbody = \"b\"\npoint = [" + std::to_string(x) +
           ", -0.1]\n" + more;
  };
  const std::string box = "[[body]]\nname = \"b\"\nmass = 1.2\ninertia = 0.02\n";
  const std::string floor = "wall = {normal = [0, 1]}\n";
  // A load off the centre turns the box as it falls from rest.
  const std::string sliding = "gravity = [3, -9.81]\n" + box + "position = [0, 0.1]\n" +
                              corner("c", -0.15, floor + "mu = 0.2\n") + corner("d", 0.15, floor + "mu = 0.2\n");
  const std::string beside = sliding + "[[load]]\nname = \"l\"\nbody = \"b\"\npoint = [0.05, 0]\nforce = [0, -2]\n";
  const MotionTrial height{"body.b.position", "[0, ", "]", 0.1};
  CHECK(none_of(sliding, height, 0.05) == "");
  CHECK(none_of(beside, height, 0.05).find("square root of the change") != std::string::npos);
  // Three corners on one plane, of which one has no load.
  const std::string three = "gravity = [0, -9.81]\n" + box + "position = [0, 0.1]\n" + corner("c", -0.15, floor) +
                            corner("d", 0.15, floor) + corner("e", 0.02, floor);
  for (const auto& [name, x] : {std::pair{"c", "-0.150000"}, {"d", "0.150000"}, {"e", "0.020000"}})
    CHECK(none_of(three, {std::string("contact.") + name + ".point", std::string("[") + x + ", ", "]", -0.1}, 0.05)
              .find("depend on each other") != std::string::npos);
  CHECK(none_of(three, height, 0.05) == "");
  // Both corners of a tilted box stop as one strikes: another direction of one wall lets one of them slide.
  const std::string wall = "wall = {normal = [-0.09983341664682815, 0.9950041652780258]}\nmu = 0.05\ne_n = 0.3\n";
  const std::string tilted = "gravity = [0, -9.81]\n" + box +
                             "position = [-0.0159593373075954, 0.15906104017565884]\nangle = 0.6022461200243447\n" +
                             corner("c", -0.15, wall) + corner("d", 0.15, wall);
  const MotionTrial turned{"contact.d.wall", "{normal = [-0.09983341664682815, ", "]}", 0.9950041652780258};
  CHECK(none_of(tilted, turned, 0.17) == "");
  CHECK(none_of(tilted, turned, 0.19).find("strike at once and stick") != std::string::npos);
  CHECK(none_of(tilted, {"body.b.mass", "", "", 1.2}, 0.19) == "");
}

TEST_CASE("tangent of a motion: a box at rest, one corner of which comes to the bound of its friction") {
  std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "b"
mass = 1
inertia = 0.02
position = [0, 0.15]
[[load]]
name = "push"
body = "b"
point = [0, 0.1]
force = [1, 0]
factor = {type = "table", times = [0, 1], values = [0, 3.5]}
)";
  for (const std::string x : {"-0.2", "0.2"})
    text += "[[contact]]\ntype = \"corner-wall\"\nbody = \"b\"\npoint = [" + x +
            ", -0.15]\nwall = {normal = [0, 1]}\nmu = 0.4\n";
  const auto solver = make_solver("auto");
  const MotionTangent t = differentiate_motion(System(from_text(text)({})),
                                               parameters_of(text, {{"body.b.mass", "", "", 1}}), {}, *solver, 1);
  CHECK(t.none == "");
  CHECK(t.q.lpNorm<Eigen::Infinity>() < 1e-9);
}

TEST_CASE("tangent of a motion: an overlap at the start stays, and is refused") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "d"
mass = 1
inertia = 0.005
position = [0, 0.095]
[[contact]]
name = "c"
type = "disc-wall"
body = "d"
radius = 0.1
wall = {normal = [0, 1]}
)";
  const auto solver = make_solver("auto");
  const MotionTrial radius{"contact.c.radius", "", "", 0.1};
  const MotionTangent t =
      differentiate_motion(System(from_text(text)({})), parameters_of(text, {radius}), {}, *solver, 0.1);
  CHECK(t.none.find("the contact 'c' overlaps by 0.005") != std::string::npos);
}

TEST_CASE("tangent of a motion: a taut rope that swings turns as it falls back, and is refused") {
  const auto rope = [](const std::string& velocity) {
    return R"(
gravity = [0, -9.81]
[[body]]
name = "a"
mass = 1
inertia = 0.1
position = [0, -1]
velocity = )" +
           velocity +
           R"(
[[contact]]
name = "c"
type = "rope"
bodies = ["a", "ground"]
length = 1
)";
  };
  const auto solver = make_solver("auto");
  const MotionTrial height{"body.a.position", "[0, ", "]", -1};
  const auto of = [&](const std::string& text) {
    return differentiate_motion(System(from_text(text)({})), parameters_of(text, {height}), {}, *solver, 0.1);
  };
  CHECK(of(rope("[0.5, 0]")).none.find("their directions turn in the short flight") != std::string::npos);
  const MotionTangent hangs = of(rope("[0, 0]"));
  CHECK(hangs.none == "");
  CHECK(hangs.warnings.size() == 1);
}
