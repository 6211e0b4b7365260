// Rotations and steps between spatial poses against rotation matrices.
#include <orthant/core/mechanics/blocks.h>
#include <orthant/core/mechanics/spatial/inertia.h>

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

namespace {

Vector3d turn(int seed, double size) {
  return size * Vector3d(std::sin(seed + 1.0), std::cos(3.0 * seed), std::sin(5.0 * seed + 2.0)).normalized();
}
Eigen::Matrix3d by_axis(const Vector3d& phi) {
  return phi.norm() > 0 ? Eigen::AngleAxisd(phi.norm(), phi.normalized()).toRotationMatrix()
                        : Eigen::Matrix3d::Identity();
}

}  // namespace

TEST_CASE("the exponential is the rotation about an axis, and the logarithm gives the rotation vector back") {
  for (const double size : {0.0, 1e-12, 1e-9, 9e-5, 1.1e-4, 1e-2, 1.0, 3.0, std::numbers::pi - 1e-6}) {
    CAPTURE(size);
    const Vector3d phi = turn(3, size);
    const Eigen::Vector4d q = quaternions::exponential(phi);
    CHECK(std::abs(q.norm() - 1) < 1e-15);
    CHECK((quaternions::matrix_of(q) - by_axis(phi)).cwiseAbs().maxCoeff() < 1e-15);
    CHECK((quaternions::logarithm(q) - phi).norm() <= 1e-15 * (1 + size) + 4e-16 * size);
    CHECK((quaternions::logarithm(Eigen::Vector4d(-q)) - phi).norm() <= 4e-15 * size);
  }
}

TEST_CASE("a step moves a pose by the velocity in body axes, and between() finds it") {
  Eigen::VectorXd q(14), step(12), there;
  q << 1, 2, 3, quaternions::exponential(turn(1, 2)), -4, 5, -6, quaternions::exponential(turn(2, 3));
  step << 0.1, -0.2, 0.3, turn(4, 0.7), 1, 2, -1, turn(5, 2.9);
  move<Spatial>(q, step, there);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Matrix3d R = quaternions::matrix_of(quaternion(q, i));
    CHECK((place_of<Spatial>(there, i) - place_of<Spatial>(q, i) - translation<Spatial>(step, i)).norm() < 1e-15);
    CHECK(
        (quaternions::matrix_of(quaternion(there, i)) - R * by_axis(rotation<Spatial>(step, i))).cwiseAbs().maxCoeff() <
        2e-15);
  }
  CHECK((between<Spatial>(q, there) - step).norm() < 1e-14);
  move<Spatial>(q, step);
  CHECK(q == there);
}

TEST_CASE("quaternions stay unit over a million steps") {
  Eigen::VectorXd q(7), step(6);
  q << 0, 0, 0, 1, 0, 0, 0;
  step << 0, 0, 0, turn(7, 0.01);
  for (int i = 0; i < 1'000'000; ++i) move<Spatial>(q, step);
  CHECK(std::abs(quaternion(q, 0).norm() - 1) < 4e-16);
  const double full = 2 * std::numbers::pi;
  const Vector3d left = quaternions::logarithm(quaternion(q, 0));
  const double turned = std::remainder(1e4, full);
  CHECK((left - turn(7, turned)).norm() < 1e-9);
}

TEST_CASE("principal axes diagonalize any tensor, and leave a diagonal one as it is") {
  const Eigen::Matrix3d R = by_axis(turn(1, 1.3));
  const Vector3d J(2, 3, 4);
  const spatial::Principal p = spatial::principal(R * J.asDiagonal() * R.transpose());
  const Eigen::Matrix3d A = quaternions::matrix_of(p.axes);
  CHECK((p.moments - J).norm() < 1e-14);
  CHECK((A * p.moments.asDiagonal() * A.transpose() - R * J.asDiagonal() * R.transpose()).norm() < 1e-14);
  const spatial::Principal own = spatial::principal(Vector3d(4, 2, 3).asDiagonal());
  CHECK(own.moments == Vector3d(4, 2, 3));
  CHECK(own.axes == Eigen::Vector4d(1, 0, 0, 0));
}
