// Anderson acceleration: fixed points of linear maps that are no contractions, and of one that circles around its own.
#include <doctest/doctest.h>

#include <orthant/solvers/linear_algebra/anderson.h>

#include <Eigen/LU>
#include <cmath>

using namespace orthant;

TEST_CASE("Anderson: a linear map of n unknowns ends in n + 1 images, however far it throws") {
  const Eigen::Matrix3d B{{1.5, 0.4, 0}, {-2, 0.3, 0.1}, {0.2, 0, -3}};
  const Eigen::Vector3d c{1, -2, 3}, fixed = (Eigen::Matrix3d::Identity() - B).inverse() * c;
  Anderson mixing;
  Vector x{0, 0, 0}, image;
  for (int k = 0; k < 4; ++k) image = B * x + c, mixing.next(x, image);
  CHECK((x - fixed).norm() < 1e-12);
  // The same in other units of one entry, with their scale.
  const Eigen::Vector3d scale{1, 1e-3, 1};
  mixing.restart();
  Eigen::VectorXd y = Eigen::VectorXd::Zero(3);
  for (int k = 0; k < 4; ++k) mixing.next(y, Eigen::VectorXd(B * y + c), scale);
  CHECK((y - fixed).norm() < 1e-11);
}

TEST_CASE("Anderson: iterates that circle around the fixed point at a bound of the map find it") {
  const double angle = 0.7, grow = 1.1;
  const Eigen::Matrix2d turn{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
  const Eigen::Vector2d fixed{0.3, -0.2};
  const auto map = [&](const Vector& x) -> Eigen::Vector2d {
    return fixed + (grow * turn * (x - fixed)).cwiseMax(-0.1).cwiseMin(0.1);
  };
  Vector plain{0.35, -0.2};
  for (int k = 0; k < 200; ++k) plain = Eigen::Vector2d(map(plain));
  CHECK((plain - fixed).norm() > 0.05);
  Anderson mixing;
  Vector x{0.35, -0.2}, image;
  for (int k = 0; k < 10; ++k) image = map(x), mixing.next(x, image);
  CHECK((x - fixed).norm() < 1e-12);
}
