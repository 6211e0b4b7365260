// Frames and inertias of imported models: turns of all kinds, products of inertia, bodies of several geoms.
#include "tests/core/mechanics/models/imported.h"

#include <orthant/core/support/options.h>
#include <orthant/core/support/random.h>

#include <Eigen/Geometry>

#include <numbers>

using namespace orthant;

namespace {

Eigen::Matrix3d turn_about(int axis, double angle) {
  return Eigen::AngleAxisd(angle, Vector3d::Unit(axis)).toRotationMatrix();
}

/// The only body of a model.
spatial::Body only_body(const std::string& model, const std::vector<std::string>& sets = {}) {
  const Imported t = taken(model, sets);
  REQUIRE(t.scene.bodies.size() == 1);
  return t.scene.bodies[0];
}

Eigen::Matrix3d tensor(double xx, double yy, double zz, double xy, double xz, double yz) {
  return Eigen::Matrix3d{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
}

}  // namespace

TEST_CASE("URDF: a tensor with products of inertia is turned by roll, pitch and yaw, about x, y and z in this order") {
  const spatial::Body b = only_body(
      "<robot name='r'><link name='b'><inertial><origin xyz='1 2 3' rpy='0.3 -0.4 0.9'/><mass value='2'/>"
      "<inertia ixx='3' iyy='4' izz='5' ixy='0.1' ixz='0.2' iyz='-0.3'/></inertial></link></robot>",
      {"base=free"});
  const Eigen::Matrix3d R = turn_about(2, 0.9) * turn_about(1, -0.4) * turn_about(0, 0.3);
  CHECK((b.inertia - R * tensor(3, 4, 5, 0.1, 0.2, -0.3) * R.transpose()).norm() < 1e-14);
  CHECK((b.position - Vector3d(1, 2, 3)).norm() < 1e-15);
}

TEST_CASE("MJCF: fullinertia has the order xx, yy, zz, xy, xz, yz") {
  const spatial::Body b = only_body(
      mujoco(world("<body><freejoint/><inertial pos='0 0 0' mass='2' fullinertia='3 4 5 0.1 0.2 -0.3'/></body>")));
  CHECK((b.inertia - tensor(3, 4, 5, 0.1, 0.2, -0.3)).norm() < 1e-14);
}

TEST_CASE("MJCF: Euler angles about axes that stay, about axes that turn along, an axis with an angle in degrees") {
  constexpr double kDegree = std::numbers::pi / 180;
  const auto turn_of = [](const char* sequence, const char* turn) {
    return Eigen::Matrix3d(quaternions::matrix_of(
        only_body(mujoco("<compiler eulerseq='" + std::string(sequence) + "'/>" +
                         world("<body " + std::string(turn) + "><freejoint/><geom size='0.1'/></body>")))
            .orientation));
  };
  const Eigen::Matrix3d x = turn_about(0, 30 * kDegree), y = turn_about(1, 40 * kDegree),
                        z = turn_about(2, 50 * kDegree);
  CHECK((turn_of("xyz", "euler='30 40 50'") - x * y * z).norm() < 1e-14);
  CHECK((turn_of("XYZ", "euler='30 40 50'") - z * y * x).norm() < 1e-14);
  CHECK((turn_of("zYx", "euler='50 40 30'") - y * z * x).norm() < 1e-14);
  const Eigen::Matrix3d skew = Eigen::AngleAxisd(60 * kDegree, Vector3d(1, 2, 2) / 3).toRotationMatrix();
  CHECK((turn_of("xyz", "axisangle='1 2 2 60'") - skew).norm() < 1e-14);
}

TEST_CASE("MJCF: a body of two geoms has the centre and the inertia of both, with lengths of twice the half lengths") {
  const spatial::Body b =
      only_body(mujoco(world("<body><freejoint/><geom type='capsule' size='0.1 0.5' pos='0.3 -0.2 1' density='700'/>"
                             "<geom type='cylinder' size='0.2 0.4' pos='1 0.5 0' density='900'/></body>")));
  const spatial::Solid solids[] = {spatial::capsule(0.1, 1), spatial::cylinder(0.2, 0.8)};
  const double masses[] = {700 * solids[0].volume, 900 * solids[1].volume};
  const Vector3d places[] = {{0.3, -0.2, 1}, {1, 0.5, 0}};
  const double mass = masses[0] + masses[1];
  const Vector3d centre = (masses[0] * places[0] + masses[1] * places[1]) / mass;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 2; ++i) {
    const Vector3d d = places[i] - centre;
    inertia += masses[i] *
               (Eigen::Matrix3d(solids[i].inertia) + d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  CHECK(b.mass == doctest::Approx(mass).epsilon(1e-14));
  CHECK((b.position - centre).norm() < 1e-14);
  CHECK((b.inertia - inertia).norm() < 1e-12 * inertia.norm());
}

TEST_CASE("MJCF: of boxes in one tree just those that overlap at the start do not meet") {
  struct Box {
    Vector3d at, half;
    Eigen::Matrix3d R;
    double reach(const Vector3d& d) const { return half.dot((R.transpose() * d).cwiseAbs()); }
  };
  Random random(3);
  std::vector<Box> boxes;
  std::string bodies;
  const auto list = [](const Vector3d& x) {
    return detail::text_of(x.x()) + " " + detail::text_of(x.y()) + " " + detail::text_of(x.z());
  };
  const auto any = [&](double lo, double hi) {
    return Vector3d(random.uniform(lo, hi), random.uniform(lo, hi), random.uniform(lo, hi));
  };
  for (int i = 0; i < 60; ++i) {
    Box b{any(-0.8, 0.8), any(0.01, 0.4), {}};
    const Vector3d turn = any(-180, 180);
    b.R = turn_about(0, turn.x() * std::numbers::pi / 180) * turn_about(1, turn.y() * std::numbers::pi / 180) *
          turn_about(2, turn.z() * std::numbers::pi / 180);
    bodies += "<body pos='" + list(b.at) + "' euler='" + list(turn) + "'><joint/><geom type='box' size='" +
              list(b.half) + "'/></body>\n";
    boxes.push_back(b);
  }
  const Imported t = taken(mujoco(world("<body><freejoint/><geom size='0.1' pos='0 0 9'/>" + bodies + "</body>")));
  REQUIRE(t.scene.collisions.size() == 1);
  REQUIRE(t.scene.bodies.size() == boxes.size() + 1);
  const auto& apart = t.scene.collisions[0].apart;
  int overlaps = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Box &a = boxes[i], &b = boxes[k];
      std::vector<Vector3d> axes;  // separating axes of two boxes: faces, and pairs of edges
      for (int m = 0; m < 3; ++m) {
        axes.push_back(a.R.col(m)), axes.push_back(b.R.col(m));
        for (int n = 0; n < 3; ++n)
          axes.push_back(Vector3d(Vector3d(a.R.col(m)).cross(Vector3d(b.R.col(n)))).normalized());
      }
      double gap = -1e9;
      for (const Vector3d& d : axes) gap = std::max(gap, std::abs(d.dot(a.at - b.at)) - a.reach(d) - b.reach(d));
      REQUIRE(std::abs(gap) > 1e-6);  // no two that nearly touch
      const auto one = static_cast<BodyId>(i + 1), other = static_cast<BodyId>(k + 1);
      const bool listed = std::ranges::any_of(apart, [&](const auto& pair) {
        return pair == std::pair{one, other} || pair == std::pair{other, one};
      });
      CAPTURE(i);
      CAPTURE(k);
      CAPTURE(gap);
      CHECK(listed == (gap < 0));
      overlaps += gap < 0;
    }
  CHECK(overlaps > 50);
  CHECK(overlaps < 1700);
}
