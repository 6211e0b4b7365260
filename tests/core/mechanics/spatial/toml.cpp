// Scenes in space from TOML: every element, defaults from the initial poses, and mistakes with their place.
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/geometry.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

constexpr const char* kText = R"(dimension = 3
gravity = [0, 0, -9.81]
duration = 2
step = 0.01

[[body]]
name = "arm"
mass = 2
inertia = [[2, 0.5, 0], [0.5, 3, 0], [0, 0, 4]]
position = [1, 0, 0]
angle = 0.5
axis = [0, 0, 2]
velocity = [0, 1, 0]
omega = [0, 0, 1]

[[body]]
name = "ball"
mass = 1
inertia = 0.4
orientation = [2, 0, 0, 0]

[[joint]]
type = "revolute"
name = "shoulder"
bodies = ["ground", "arm"]
point_b = [-1, 0, 0]
axis = [0, 0, 1]

[[joint]]
type = "drive"
joint = "shoulder"
rate = 3

[[joint]]
type = "spherical"
bodies = ["arm", "ball"]

[[contact]]
type = "box-wall"
name = "floor"
body = "arm"
size = [1, 1, 1]
wall = {point = [0, 0, -5], normal = [0, 0, 3]}
mu = 0.3
e_n = 0.5

[[contact]]
type = "limit"
name = "stop"
joint = "shoulder"
lower = -1
upper = 1

[[spring]]
type = "point"
bodies = ["ground", "ball"]
stiffness = 10

[[friction]]
joint = "shoulder"
bound = 0.2

[[load]]
body = "ball"
force = [1, 2, 3]
torque = [0, 0, 1]
frame = "body"
factor = {type = "cosine", omega = 2}
)";

spatial::Scene parsed(std::vector<std::string> overrides = {}) {
  return std::get<spatial::Scene>(parse_any_scene(kText, overrides, "arm.toml"));
}
std::string refusal(const std::string& one) {
  try {
    parsed({one});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a scene in space is read with every element") {
  const spatial::Scene s = parsed();
  CHECK(s.gravity == Vector3d(0, 0, -9.81));
  REQUIRE(s.bodies.size() == 2);
  CHECK(s.bodies[0].inertia(0, 1) == 0.5);
  CHECK((s.bodies[0].orientation - Eigen::Vector4d(std::cos(0.25), 0, 0, std::sin(0.25))).norm() < 1e-15);
  CHECK(s.bodies[1].inertia == Eigen::Matrix3d(0.4 * Eigen::Matrix3d::Identity()));
  CHECK(s.bodies[1].orientation == Eigen::Vector4d(1, 0, 0, 0));
  const auto& shoulder = std::get<spatial::Revolute>(s.joints.at(0));
  spatial::Kinematics k;
  for (const spatial::Body& b : s.bodies) k.pose.push_back({b.position, quaternions::matrix_of(b.orientation), {}});
  k.pose.emplace_back();
  CHECK(std::abs(shoulder.angle().value(k)) < 1e-15);  // 0 in the initial pose, whatever the bodies' frames
  CHECK(std::get<spatial::Drive>(s.joints.at(1)).law.rate_of_change == 3);
  CHECK(s.contacts.size() == 8 + 2);
  const auto& corner = std::get<spatial::SpherePlane>(s.contacts[0]);
  CHECK(corner.normal == Vector3d(0, 0, 1));
  CHECK(corner.law.mu == 0.3);
  CHECK(corner.radius == 0);
  CHECK(corner.centre.cwiseAbs() == Vector3d(0.5, 0.5, 0.5));
  CHECK(std::get<spatial::PointSpring>(s.springs.at(0)).rest == 0);
  CHECK(s.loads.at(0).frame == spatial::Frame::body);
  CHECK(s.loads.at(0).factor(0.5) == std::cos(1.0));
  CHECK(std::get<spatial::Revolute>(parsed({"joint.shoulder.angle=0.4"}).joints[0]).angle().value(k) ==
        doctest::Approx(0.4).epsilon(1e-12));
}

TEST_CASE("mistakes in scenes in space name file or override, element, key, value and rule") {
  CHECK(refusal("gravity=[0, 1]") == "override gravity=[0, 1]: gravity = [0, 1]: must be three numbers [x, y, z]");
  CHECK(refusal("body.arm.mass=-1") == "override body.arm.mass=-1: body \"arm\": mass = -1: must be > 0");
  CHECK(refusal("body.ball.orientation=[0, 0, 0, 0]").find("must be a quaternion [w, x, y, z], not zero") !=
        std::string::npos);
  CHECK(refusal("body.ball.inertia=[1, 1, 3]").find("must be that of a body") != std::string::npos);
  CHECK(refusal("joint.shoulder.type=\"hinge\"").find("must be spherical, revolute") != std::string::npos);
  CHECK(refusal("joint.shoulder.bodies=[\"ground\", \"leg\"]").find("must be the name of a body: ground, arm, ball") !=
        std::string::npos);
  CHECK(refusal("contact.floor.mu=-1").find("contact \"floor_1\": mu = -1: must be >= 0") != std::string::npos);
  CHECK(refusal("contact.floor.belt=1").find("unknown key \"belt\"") != std::string::npos);
  CHECK(refusal("dimension=4").find("dimension = 4: must be 2 here, or 3 where scenes in space are taken") !=
        std::string::npos);
}

TEST_CASE("angles in space: axes that no joint keeps, and starts that leave the number of turns open, are refused") {
  const auto said = [](const std::string& joint, const std::string& reader) -> std::string {
    try {
      static_cast<void>(
          parse_any_scene("dimension = 3\n[[body]]\nname = 'b'\nmass = 1\ninertia = 1\n[[body]]\n"
                          "name = 'c'\nmass = 1\ninertia = 1\n[[joint]]\nname = 'j'\nbodies = "
                          "['ground', 'b']\n" +
                              joint + reader,
                          {}, "x.toml"));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  };
  const std::string about = "of = 'angle'\nbodies = ['ground', 'b']\naxis = [0, 0, 1]\n", ball = "type = 'spherical'\n",
                    hinge = "type = 'revolute'\naxis = [0, 0, 1]\n", tilted = "type = 'revolute'\naxis = [0, 1, 1]\n",
                    second = "[[joint]]\ntype = 'revolute'\nbodies = ['b', 'c']\naxis = [0, 0, -1]\n",
                    drive = "[[joint]]\ntype = 'drive'\nname = 'd'\nrate = 1\n",
                    spring = "[[spring]]\ntype = 'joint'\nname = 's'\nstiffness = 1\n",
                    stop = "[[contact]]\ntype = 'limit'\nname = 'l'\n",
                    friction = "[[friction]]\nname = 'f'\nbound = 1\n", of_j = "joint = 'j'\n",
                    far = "of = 'angle'\nbodies = ['ground', 'c']\naxis = [0, 0, 1]\n";
  const auto refused = [&](const std::string& text, const std::string& words) {
    INFO(text);
    CHECK(text.starts_with("x.toml:"));
    CHECK(text.find(words) != std::string::npos);
  };
  const std::string axis = "of = \"angle\": must be about an axis that joints keep together in both bodies";
  refused(said(ball, drive + about), "joint \"d\": " + axis);
  refused(said(ball, spring + about), "spring \"s\": " + axis);
  refused(said(ball, stop + about + "upper = 1\n"), "contact \"l\": " + axis);
  refused(said(ball, friction + about), "friction \"f\": " + axis);
  refused(said(tilted, drive + about), axis);
  refused(said(hinge, drive + far), axis);
  CHECK(said(hinge, drive + about) == "taken");
  CHECK(said(hinge + second, drive + far) == "taken");

  refused(said(hinge, spring + of_j + "rest = 4\n"),
          "spring \"s\": rest = 4: must be less than half a turn from the angle at the start, 0");
  refused(said(hinge + "angle = 2\n", spring + of_j + "rest = -2\n"), "rest = -2: must be");
  CHECK(said(hinge + "angle = 2\n", spring + of_j + "rest = 4\n") == "taken");
  CHECK(said(hinge, "[[spring]]\ntype = 'joint'\ndamping = 1\nrest = 4\n" + of_j) == "taken");
  refused(said(hinge, stop + of_j + "upper = 4\n"), "contact \"l\": upper = 4: must be less than half a turn");
  refused(said(hinge, stop + of_j + "lower = 3\nupper = 5\n"),
          "lower = 3: must be so that the middle of the bounds, 4, is less than half a turn from the angle at the "
          "start, 0");
  CHECK(said(hinge, stop + of_j + "lower = -1\nupper = 5\n") == "taken");
  refused(said(hinge + "angle = 4\n", ""), "angle = 4: must be from -pi to pi");
}

TEST_CASE("readers of planar scenes refuse a file in space by its dimension") {
  CHECK_THROWS_WITH_AS(static_cast<void>(parse_scene(kText, {}, "arm.toml")),
                       "arm.toml:1: dimension = 3: must be 2 here, or 3 where scenes in space are taken",
                       std::invalid_argument);
  CHECK(std::holds_alternative<Scene>(
      parse_any_scene("dimension = 2\n[[body]]\nname = \"a\"\nmass = 1\ninertia = 1\n", {}, "a.toml")));
}
