// Models in URDF and MJCF move as the same mechanism built by hand.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <doctest/doctest.h>

#include <numbers>
#include <sstream>

using namespace orthant;

namespace {

constexpr double kArm1 = 0.8, kArm2 = 0.6, kBallMass = 3;  // [m, m, kg]
const Vector3d kFirst(0.2, -0.5, 1.1);                     // [rad] turns of the second hinge's frame in the first arm

spatial::Scene imported_scene(const std::string& text, const std::vector<std::string>& sets) {
  return std::get<spatial::Scene>(parse_any_scene(import_model(text, "model.xml", sets).toml, {}, "imported"));
}

/// A double pendulum in space: two capsules of density 1000, hinges about y and about an oblique axis.
spatial::Scene pendulum_by_hand(double first, double second) {
  const auto turn = [](double angle, const Vector3d& u) { return Eigen::AngleAxisd(angle, u).toRotationMatrix(); };
  const Eigen::Matrix3d between =
      turn(kFirst.z(), Vector3d::UnitZ()) * turn(kFirst.y(), Vector3d::UnitY()) * turn(kFirst.x(), Vector3d::UnitX());
  const Vector3d y(0, 1, 0), oblique = Vector3d(1, 2, 0.5).normalized(), down1(0, 0, -kArm1), down2(0, 0, -kArm2);
  const Eigen::Matrix3d R1 = turn(first, y), R2 = R1 * between * turn(second, oblique);
  const auto quaternion = [](const Eigen::Matrix3d& R) {
    const Eigen::Quaterniond q(R);
    return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).normalized().eval();
  };
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  const spatial::Solid one = spatial::capsule(0.05, kArm1), two = spatial::capsule(0.04, kArm2);
  const double m1 = 1000 * one.volume, m2 = 1000 * two.volume;
  const Vector3d hook = R1 * down1;
  const auto upper = s.body(
      {.name = "upper", .mass = m1, .inertia = m1 * one.inertia, .position = hook / 2, .orientation = quaternion(R1)});
  const auto lower = s.body({.name = "lower",
                             .mass = m2,
                             .inertia = m2 * two.inertia,
                             .position = hook + R2 * down2 / 2,
                             .orientation = quaternion(R2)});
  s.joint(spatial::Revolute{"pin", kGround, upper, {0, 0, 0}, -down1 / 2, y, y});
  s.joint(spatial::Revolute{"elbow", upper, lower, down1 / 2, -down2 / 2, between * oblique, oblique});
  return s;
}

std::string number_text(double x) {
  std::ostringstream out;
  out.precision(17);
  out << x;
  return out.str();
}
std::string tensor_text(const Eigen::Matrix3d& J) {
  return "<inertia ixx='" + number_text(J(0, 0)) + "' ixy='" + number_text(J(0, 1)) + "' ixz='" + number_text(J(0, 2)) +
         "' iyy='" + number_text(J(1, 1)) + "' iyz='" + number_text(J(1, 2)) + "' izz='" + number_text(J(2, 2)) + "'/>";
}

/// Inertias in turned frames, the upper arm in two links with a fixed joint between them.
std::string pendulum_urdf() {
  const spatial::Solid one = spatial::capsule(0.05, kArm1), two = spatial::capsule(0.04, kArm2);
  const double m1 = 1000 * one.volume, m2 = 1000 * two.volume;
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.3, Vector3d::UnitX()).toRotationMatrix();
  const auto inertial = [&](double mass, const Vector3d& at, const Eigen::Matrix3d& J) {  // in a frame turned about x
    return "<inertial><origin xyz='0 0 " + number_text(at.z()) + "' rpy='0.3 0 0'/><mass value='" + number_text(mass) +
           "'/>" + tensor_text(turned.transpose() * J * turned) + "</inertial>";
  };
  // Half of the mass a quarter of the arm above the middle, half below: the inertias less what that makes.
  const double apart = kArm1 / 4, shift = apart * apart;
  const Eigen::Matrix3d half = m1 / 2 * (one.inertia - Vector3d(shift, shift, 0).asDiagonal().toDenseMatrix());
  return "<robot name='pendulum'><link name='world'/><link name='upper'>" +
         inertial(m1 / 2, {0, 0, -kArm1 / 2 + apart}, half) + "</link><link name='rest'>" +
         inertial(m1 / 2, {0, 0, -apart}, half) + "</link><link name='lower'>" +
         inertial(m2, {0, 0, -kArm2 / 2}, m2 * two.inertia) +
         "</link><joint name='pin' type='continuous'><parent link='world'/><child link='upper'/><axis xyz='0 1 "
         "0'/></joint>"
         "<joint name='weld' type='fixed'><parent link='upper'/><child link='rest'/><origin xyz='0 0 " +
         number_text(-kArm1 / 2) +
         "'/></joint><joint name='elbow' type='continuous'><parent link='rest'/><child link='lower'/><origin xyz='0 "
         "0 " +
         number_text(-kArm1 / 2) + "' rpy='" + number_text(kFirst.x()) + " " + number_text(kFirst.y()) + " " +
         number_text(kFirst.z()) + "'/><axis xyz='1 2 0.5'/></joint></robot>";
}

std::string pendulum_mjcf() {
  const double degree = std::numbers::pi / 180;
  const Vector3d turns = kFirst / degree;
  const auto capsule = [](double radius, double length) {
    return "<geom type='capsule' size='" + number_text(radius) + "' fromto='0 0 0 0 0 " + number_text(-length) +
           "' contype='0' conaffinity='0'/>";
  };
  return "<mujoco><compiler eulerseq='XYZ'/><worldbody><body name='upper'><joint name='pin' axis='0 1 0'/>" +
         capsule(0.05, kArm1) + "<body name='lower' pos='0 0 " + number_text(-kArm1) + "' euler='" +
         number_text(turns.x()) + " " + number_text(turns.y()) + " " + number_text(turns.z()) +
         "'><joint name='elbow' axis='1 2 0.5'/>" + capsule(0.04, kArm2) + "</body></body></worldbody></mujoco>";
}

}  // namespace

TEST_CASE("a double pendulum in URDF and in MJCF moves as the one built by hand, to 1e-12") {
  const std::vector<std::string> sets = {"at.pin=1.2", "at.elbow=-0.7"};
  const SpatialSystem by_hand(pendulum_by_hand(1.2, -0.7));
  for (const auto& text : {pendulum_urdf(), pendulum_mjcf()}) {
    CAPTURE(text);
    const SpatialSystem imported(imported_scene(text, sets));
    REQUIRE(imported.bodies() == 2);
    std::vector<Vector3d> wanted;
    run_in_space(by_hand, "moreau-jean", 1e-3, 1, [&](const SpatialSample& m) {
      for (int i = 0; i < 2; ++i) wanted.push_back(poses_of(by_hand, m.state).at(i).x);
    });
    std::size_t k = 0;
    double apart = 0, way = 0;
    run_in_space(imported, "moreau-jean", 1e-3, 1, [&](const SpatialSample& m) {
      for (int i = 0; i < 2; ++i) {
        apart = std::max(apart, (poses_of(imported, m.state).at(i).x - wanted[k]).norm());
        way = std::max(way, (wanted[k] - wanted[static_cast<std::size_t>(i)]).norm());
        ++k;
      }
    });
    MESSAGE("apart " << apart << " m");
    CHECK(k == wanted.size());
    CHECK(way > 0.8);
    CHECK(apart < 1e-12);
  }
}

TEST_CASE("a ball on three hinges moves as one on a spherical joint; a cart with a wheel as a planar joint") {
  const std::string start = "<mujoco><worldbody><body name='b'>",
                    rest = "<inertial pos='0.3 0 -0.4' mass='" + number_text(kBallMass) +
                           "' diaginertia='0.1 0.2 0.25'/></body></worldbody></mujoco>";
  const auto end_of = [&](const std::string& joints) {
    const SpatialSystem system(imported_scene(start + joints + rest, {}));
    return run_in_space(system, "moreau-jean", 1e-3, 0.5).final.q;
  };
  const auto ball = end_of("<joint type='ball'/>");
  const auto hinges = end_of("<joint axis='1 0 0'/><joint axis='0 1 0'/><joint axis='0 0 1'/>");
  CHECK(ball == hinges);
  CHECK((ball.head<3>() - Vector3d(0.3, 0, -0.4)).norm() > 0.05);
  const auto planar =
      end_of("<joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 0 1'/><joint axis='0 1 0'/>");
  CHECK(std::abs(planar[1]) < 1e-15);
  CHECK(planar[2] + 0.4 == doctest::Approx(-9.81 / 2 * 0.25).epsilon(1e-2));  // falls
}

TEST_CASE("bodies that a collision keeps apart pass through each other; others meet") {
  const auto height_after = [](const std::string& exclude) {
    const spatial::Scene s = imported_scene(
        "<mujoco><worldbody><geom name='table' type='box' size='1 1 0.1'/><body name='ball' pos='0 0 0.3'><freejoint/>"
        "<geom size='0.1'/></body></worldbody>" +
            exclude + "</mujoco>",
        {});
    return run_in_space(SpatialSystem(s), "moreau-jean", 1e-3, 0.5).final.q[2];
  };
  CHECK(height_after("") == doctest::Approx(0.2).epsilon(1e-2));
  CHECK(height_after("<contact><exclude body1='world' body2='ball'/></contact>") < -0.5);
}

TEST_CASE("a joint whose limits are almost a full turn apart stops at both of them") {
  for (const double speed : {-8.0, 8.0}) {
    spatial::Scene s = imported_scene(
        "<robot name='r'><link name='base'/><link name='a'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' "
        "iyy='1' iyz='0' izz='1'/></inertial></link><joint name='j' type='revolute'><parent link='base'/><child "
        "link='a'/><axis xyz='0 0 1'/><limit lower='-2.9' upper='2.9'/></joint></robot>",
        {});
    s.bodies[0].omega = {0, 0, speed};
    const SpatialSystem system(s);
    const auto angle = std::get<spatial::Revolute>(system.scene().joints[0]).angle();
    double last = 0;
    run_in_space(system, "moreau-jean", 1e-3, 1,
                 [&](const SpatialSample& m) { last = angle.value(poses_of(system, m.state)); });
    CHECK(std::abs(last) == doctest::Approx(2.9).epsilon(1e-2));
    CHECK(last * speed > 0);
  }
}
