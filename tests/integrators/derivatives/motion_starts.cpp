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
