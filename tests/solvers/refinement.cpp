// Refinement: a solved answer of an iterative solver brought to rounding, another one left alone.
#include <orthant/core/lcp/problems/families.h>
#include <orthant/core/support/random.h>
#include <orthant/solvers/refinement.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

/// Two contacts of discs under a load that lets one stick and one slide.
Lcp two_discs() {
  Lcp p;
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(6, 6);
  A(0, 3) = A(3, 0) = 0.3, A(1, 4) = A(4, 1) = 0.2;
  p.A = DenseMatrix(A);
  p.b.resize(6);
  p.b << -1, 0.1, 0.05, -2, 0.9, -1.5;
  p.lo = Vector::Constant(6, -kInf), p.hi = Vector::Constant(6, kInf);
  p.lo[0] = p.lo[3] = 0;
  for (const Index n : {0, 3}) p.friction.push_back({.normal = n, .first = n + 1, .rows = 2, .mu = 0.5});
  return p;
}

}  // namespace

TEST_CASE("refinement brings an answer of 1e-10 to rounding, on boxes and on discs; a fine answer keeps its bits") {
  Random random(3);
  Lcp boxes;
  Eigen::MatrixXd G(12, 12);
  for (Index k = 0; k < G.size(); ++k) G.data()[k] = random.uniform(-1, 1);
  boxes.A = DenseMatrix(G * G.transpose() + Eigen::MatrixXd::Identity(12, 12));
  boxes.b.resize(12);
  for (double& b : boxes.b) b = random.uniform(-1, 1);
  boxes.lo = Vector::Zero(12), boxes.hi = Vector::Constant(12, kInf);
  for (const Lcp& problem : {boxes, two_discs()}) {
    Solution s;
    make_solver("pgs:tolerance=1e-10")->solve(problem, s);
    REQUIRE(s.status == Status::solved);
    CHECK(s.residual > 1e-13);
    Refinement refinement;
    refinement.improve(problem, s);
    CHECK(s.status == Status::solved);
    CHECK(s.residual < 1e-14);
    const Vector z = s.z;
    refinement.improve(problem, s);
    CHECK(s.z == z);
  }
}
