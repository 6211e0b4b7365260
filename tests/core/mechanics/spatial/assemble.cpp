// Assembly in space: the least motion into joints, sockets and closed loops; words where there is none.
#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

using namespace orthant;

namespace {

double off(const spatial::Scene& scene) {
  spatial::Scene still = scene;
  still.assemble = false;
  const SystemOf<Spatial> system(still);
  const State x = system.initial_state();
  return off_most(system, x.t, x.q).off;
}

/// A planar loop of three revolute joints in space: two links between pins, 15 rows of rank 12.
const std::string kLoop = R"(
  dimension = 3
  assemble = true
  [[body]]
  name = "crank"
  mass = 1
  inertia = [0.01, 0.02, 0.03]
  position = [0.2, 0.05, 0.1]
  [[body]]
  name = "rod"
  mass = 2
  inertia = [0.05, 0.06, 0.02]
  position = [0.9, 0.1, -0.1]
  [[joint]]
  type = "revolute"
  name = "O"
  bodies = ["ground", "crank"]
  point_b = [-0.25, 0, 0]
  axis = [0, 0, 1]
  [[joint]]
  type = "revolute"
  name = "A"
  bodies = ["crank", "rod"]
  point_a = [0.25, 0, 0]
  point_b = [-0.5, 0, 0]
  axis = [0, 0, 1]
  [[joint]]
  type = "revolute"
  name = "C"
  bodies = ["rod", "ground"]
  point_a = [0.5, 0, 0]
  point_b = [1.2, 0, 0]
  axis = [0, 0, 1]
)";

}  // namespace

TEST_CASE("assemble in space: two points that a spherical joint of no lever joins meet at their centre of mass") {
  spatial::Scene s;
  s.body({.mass = 1, .position = {0, 0, 0}}), s.body({.mass = 3, .position = {4, 8, -4}});
  s.joint(spatial::Spherical{.name = "pin", .a = 0, .b = 1});
  const spatial::Scene there = assembled(s);
  for (const std::size_t body : {0U, 1U}) CHECK((there.bodies[body].position - Vector3d(3, 6, -3)).norm() < 1e-12);
}

TEST_CASE("assemble in space: a turned body of any inertia comes back into a fixed joint, in its own axes") {
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.3, Vector3d(1, 2, 2) / 3));
  const Eigen::Matrix3d axes = Eigen::AngleAxisd(1.1, Vector3d(2, -1, 2) / 3).toRotationMatrix();
  spatial::Scene s;
  s.body({.mass = 2,
          .inertia = axes * Vector3d(1, 2, 2.5).asDiagonal() * axes.transpose(),
          .position = {0.1, 0.2, 0.3},
          .orientation = {turned.w(), turned.x(), turned.y(), turned.z()}});
  s.joint(spatial::Fixed{.name = "weld", .a = kGround, .b = 0});
  const spatial::Scene there = assembled(s);
  CHECK(there.bodies[0].position.norm() < 1e-12);
  CHECK(there.bodies[0].orientation.tail<3>().norm() < 1e-12);
  CHECK((there.bodies[0].inertia - s.bodies[0].inertia).norm() == 0);
}

TEST_CASE("assemble in space: a ball outside its socket touches it, one inside stays where it is") {
  const auto ball = [](const Vector3d& at) {
    spatial::Scene s;
    s.body({.mass = 1, .position = at});
    s.contact(spatial::Socket{.name = "B", .a = 0, .radius_a = 0.010, .radius_b = 0.012});
    return assembled(s).bodies[0].position;
  };
  CHECK((ball({0.006, -0.006, 0.003}) - Vector3d(0.004, -0.004, 0.002) / 3).norm() < 1e-12);
  CHECK((ball({0.001, 0, 0.0005}) - Vector3d(0.001, 0, 0.0005)).norm() == 0);
}

TEST_CASE("assemble in space: a pin comes back into its bush, from beyond its rim, too") {
  for (const bool rim_of_pin : {true, false})
    for (const double x : {0.003, 0.01, 0.0202, 0.03, 0.05}) {
      CAPTURE(rim_of_pin);
      CAPTURE(x);
      spatial::Scene s;
      s.body({.mass = 1, .position = {x, 0, 0}});
      s.contact_set(spatial::pin_in_bush(
          {.name = "B", .a = 0, .radius_a = 0.02, .radius_b = 0.0205, .rim_of_pin = rim_of_pin}, 0.1));
      CHECK(std::abs(assembled(s).bodies[0].position.x() - 0.0005) < 1e-9);
    }
}

TEST_CASE("assemble = true in space closes a loop with redundant rows; a loop that cannot close is named") {
  const spatial::Scene s = std::get<spatial::Scene>(parse_any_scene(kLoop));
  CHECK(s.assemble);
  const SystemOf<Spatial> system(s);
  const State x = system.initial_state();
  CHECK(off_most(system, x.t, x.q).off < 1e-12);
  CHECK(off(s) > 0.05);
  const auto far = parse_any_scene(kLoop, std::vector<std::string>{"joint.C.point_b=[5, 0, 0]"});
  CHECK_THROWS_WITH_AS(assembled(std::get<spatial::Scene>(far)), doctest::Contains("joint \""), std::invalid_argument);
}

TEST_CASE("assemble in space: axes at any angle become parallel by the least turn, opposite ones by half a turn") {
  const auto hinge = [](double angle, auto kind) {
    spatial::Scene s;
    const Vector3d about = Vector3d(1, -2, 0) / std::sqrt(5);
    s.body({.position = {0.3, 0.1, 0.2}, .orientation = quaternions::exponential(angle * about).normalized()});
    kind.name = "hinge", kind.a = kGround, kind.b = 0;
    s.joint(kind);
    return assembled(s).bodies[0].orientation;
  };
  constexpr double kHalf = std::numbers::pi;
  for (const double angle : {0.1, 1.0, kHalf / 2, 2.0, 3.0, kHalf - 1e-9, kHalf, -kHalf / 2}) {
    CAPTURE(angle);
    const auto tilt = [](const Eigen::Vector4d& q) { return 1 - quaternions::matrix_of(q)(2, 2); };
    CHECK(std::abs(tilt(hinge(angle, spatial::Revolute{}))) < 1e-12);
    CHECK(std::abs(tilt(hinge(angle, spatial::Cylindrical{}))) < 1e-12);
    CHECK(std::abs(tilt(hinge(angle, spatial::Screw{}))) < 1e-12);
    CHECK(std::abs(tilt(hinge(angle, spatial::PlaneJoint{}))) < 1e-12);
    CHECK(hinge(angle, spatial::Fixed{}).tail<3>().norm() < 1e-12);
    CHECK(hinge(angle, spatial::Prismatic{}).tail<3>().norm() < 1e-12);
    // Of the turns that make the axes parallel the least is about an axis at right angles to both.
    if (std::abs(angle) < 3) CHECK((hinge(angle, spatial::Revolute{}) - Eigen::Vector4d(1, 0, 0, 0)).norm() < 1e-9);
  }
  for (const double angle : {0.0, 1e-12, 0.5, kHalf}) {
    CAPTURE(angle);
    spatial::Scene s;
    s.body({.orientation = quaternions::exponential(Vector3d(0, 0, angle)).normalized()});
    s.joint(spatial::Universal{"cross", kGround, 0, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}});
    CHECK(std::abs(quaternions::matrix_of(assembled(s).bodies[0].orientation)(0, 0)) < 1e-12);
  }
}

TEST_CASE("assemble in space: a loop closes from links that are turned over") {
  for (const char* body : {"crank", "rod"}) {
    const std::vector<std::string> over = {"body." + std::string(body) + ".orientation=[0, 1, 0, 0]",
                                           "joint.O.axis_b=[0, 0, 1]", "joint.A.axis_b=[0, 0, 1]",
                                           "joint.C.axis_b=[0, 0, 1]"};
    const auto s = std::get<spatial::Scene>(parse_any_scene(kLoop, over));
    const SystemOf<Spatial> system(s);
    const State x = system.initial_state();
    CHECK(off_most(system, x.t, x.q).off < 1e-12);
    for (const auto& there : assembled(s).bodies) CHECK(quaternions::matrix_of(there.orientation)(2, 2) > 1 - 1e-12);
  }
}
