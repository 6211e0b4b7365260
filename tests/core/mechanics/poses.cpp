// Poses: the cosine and sine of a body's angle, updated from the pose before.
#include "tests/support/mechanics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace orthant {

using testing::Draws;
using testing::VectorXd;

TEST_CASE("a pose's cosine and sine are those of its angle to two roundings, whatever was there before") {
  Scene scene;
  scene.body({.mass = 1, .inertia = 1});
  const System system(scene);
  const double cell = 0x1p-5;
  std::vector<double> angles{0, -0.0, 1e-300, cell / 2, -cell / 2, 3 * cell / 2, 1e5, -1e15, 1e307, -1.7e308};
  Draws random(1);
  for (int k = 0; k < 2000; ++k) angles.push_back(random(-4, 4)), angles.push_back(angles.back() + random(-0.02, 0.02));
  Kinematics walking;
  for (const double theta : angles) {
    CAPTURE(theta);
    Kinematics fresh;
    const VectorXd q{{1.0, 2.0, theta}}, mirrored{{1.0, 2.0, -theta}};
    set_poses(system, 0, q, walking), set_poses(system, 0, q, fresh);
    const Pose &pose = walking.at(0), &anew = fresh.at(0);
    CHECK(std::abs(pose.c - std::cos(theta)) <= 0x1p-52);
    CHECK(std::abs(pose.s - std::sin(theta)) <= 0x1p-52);
    CHECK((pose.c == anew.c && pose.s == anew.s));
    set_poses(system, 0, mirrored, fresh);
    CHECK((fresh.at(0).c == pose.c && fresh.at(0).s == -pose.s));
  }
  set_poses(system, 0, VectorXd{{0.0, 0.0, std::numeric_limits<double>::infinity()}}, walking);
  CHECK(std::isnan(walking.at(0).c));
  set_poses(system, 0, VectorXd{{0.0, 0.0, 0.5}}, walking);
  CHECK(walking.at(0).s == doctest::Approx(std::sin(0.5)).epsilon(1e-15));
}

}  // namespace orthant
