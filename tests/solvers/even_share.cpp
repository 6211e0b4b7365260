// Even shares: impulses that the rows leave open do not depend on the order of rows; what the rows decide stays.
#include <orthant/solvers/even_share.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

using namespace orthant;

namespace {

/// A block of unit mass on four corners that yaws, and slides at (1.5, 0.2) m/s: normals, then tangents x, y of each
/// corner. order: of the corners.
Lcp struck_block(const std::array<int, 4>& order, double mu) {
  const double a = 0.12, b = 0.1, h = 0.05, yaw = 4;
  const Eigen::Vector3d inertia(0.01, 0.012, 0.015);
  Eigen::Matrix<double, 12, 6> J;
  Eigen::VectorXd v(12);
  Lcp p;
  for (int k = 0; k < 4; ++k) {
    const int corner = order[static_cast<std::size_t>(k)];
    const Eigen::Vector3d r(corner % 2 == 0 ? a : -a, corner < 2 ? b : -b, -h);
    const auto row = [&](int i, const Eigen::Vector3d& d) {
      J.row(i).head<3>() = d, J.row(i).tail<3>() = r.cross(d);
      const Eigen::Vector3d velocity = Eigen::Vector3d(1.5, 0.2, -1) + Eigen::Vector3d(0, 0, yaw).cross(r);
      v[i] = d.dot(velocity);
    };
    row(k, {0, 0, 1}), row(4 + 2 * k, {1, 0, 0}), row(5 + 2 * k, {0, 1, 0});
    p.friction.push_back({.normal = k, .first = 4 + 2 * k, .rows = 2, .mu = mu});
  }
  Eigen::Matrix<double, 6, 1> B;
  B << 1, 1, 1, inertia.cwiseInverse();
  p.A = DenseMatrix(J * B.asDiagonal() * J.transpose());
  p.b = v;
  p.lo = Eigen::VectorXd::Constant(12, -kInf), p.hi = Eigen::VectorXd::Constant(12, kInf);
  p.lo.head(4).setZero();
  return p;
}

}  // namespace

TEST_CASE("even shares: four corners of a block, in any order") {
  const auto solver = make_solver("auto");
  EvenShare share;
  std::array<int, 4> order{0, 1, 2, 3};
  const Lcp first = struck_block(order, 0.3);
  Solution even, s;
  solver->solve(first, even);
  REQUIRE(share.improve(first, 4, *solver, even));
  CHECK(even.residual < 1e-12);
  double off = 0, off_before = 0;
  do {
    const Lcp p = struck_block(order, 0.3);
    solver->solve(p, s);
    const auto distance = [&] {
      double most = 0;
      for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(s.z[k] - even.z[order[static_cast<std::size_t>(k)]]));
      return most;
    };
    off_before = std::max(off_before, distance());
    REQUIRE(share.improve(p, 4, *solver, s));
    off = std::max(off, distance());
  } while (std::ranges::next_permutation(order).found);
  CHECK(off < 1e-10);
  CHECK(off_before > 1e-3);  // a solver's own answers depend on it
}

TEST_CASE("even shares: three feet that come straight down, and stick, do not pull against each other") {
  const auto angle = [](int k) { return 0.3 + 2 * M_PI / 3 * k; };
  Lcp p;
  Eigen::Matrix<double, 9, 6> J;  // normals, then tangents x, y of each foot
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d r(0.1 * std::cos(angle(k)), 0.1 * std::sin(angle(k)), -0.05);
    const auto row = [&](int i, const Eigen::Vector3d& d) { J.row(i).head<3>() = d, J.row(i).tail<3>() = r.cross(d); };
    row(k, {0, 0, 1}), row(3 + 2 * k, {1, 0, 0}), row(4 + 2 * k, {0, 1, 0});
    p.friction.push_back({.normal = k, .first = 3 + 2 * k, .rows = 2, .mu = 0.5});
  }
  const Eigen::Matrix<double, 6, 1> B{1, 1, 1, 100, 100, 50}, v{0, 0, -1, 0, 0, 0};
  p.A = DenseMatrix(J * B.asDiagonal() * J.transpose());
  p.b = J * v;
  p.lo = Eigen::VectorXd::Constant(9, -kInf), p.hi = Eigen::VectorXd::Constant(9, kInf);
  p.lo.head(3).setZero();
  const auto solver = make_solver("auto");
  EvenShare share;
  Solution s;
  s.status = Status::solved, s.z = Vector::Zero(9), s.residual = 1e-15;
  s.z.head(3).setConstant(1. / 3);  // radial pulls in balance, at the bound: a solution, too
  for (int k = 0; k < 3; ++k) {
    s.z[3 + 2 * k] = 0.16 * std::cos(angle(k)), s.z[4 + 2 * k] = 0.16 * std::sin(angle(k));
  }
  REQUIRE(share.improve(p, 3, *solver, s));
  CHECK((s.z.head(3).array() - 1. / 3).abs().maxCoeff() < 1e-12);
  CHECK(s.z.tail(6).lpNorm<Eigen::Infinity>() < 1e-8);
}

TEST_CASE("even shares: normals that decide leave the answer as it is") {
  const auto solver = make_solver("auto");
  EvenShare share;
  const Lcp three = [] {
    Lcp p;
    p.A = DenseMatrix(Eigen::Matrix3d{{2, 1, 0}, {1, 2, 1}, {0, 1, 2}});
    p.b = Vector{-1, -1, -1};
    p.lo = Eigen::VectorXd::Zero(3), p.hi = Eigen::VectorXd::Constant(3, kInf);
    return p;
  }();
  Solution s;
  solver->solve(three, s);
  const Vector before = s.z;
  CHECK(!share.improve(three, 3, *solver, s));
  CHECK(s.z == before);
}
