// Methods that search for the right active rows: murty, block-pivot, newton-min, newton-fb.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/active_set/block_pivot.h>
#include <orthant/solvers/active_set/newton_fb.h>
#include <orthant/solvers/active_set/newton_min.h>
#include <orthant/solvers/pivoting/murty.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/support/judge.h"

using namespace orthant;

TEST_CASE("Murty's problem: least-index pivoting takes 1 pivot, on the transpose 2^n - 1") {
  for (Index n = 2; n <= 10; ++n) {
    Solution s;
    CHECK(Murty().solve(murty_problem(n), s).status == Status::solved);
    CHECK(s.iterations == 1);
    CHECK(Murty().solve(murty_problem(n, true), s).status == Status::solved);
    CHECK(s.iterations == (1 << n) - 1);
    CHECK(s.z[n - 1] == 1);
  }
}

TEST_CASE("circulant P-matrix: every start support ends, none cycles") {
  Eigen::Matrix3d M;
  M << 1, 2, 0, 0, 1, 2, 2, 0, 1;
  const Lcp p = Lcp::standard(DenseMatrix(M), Vector{-1, -1, -1});
  for (const std::string name : {"block-pivot", "newton-min", "newton-fb", "murty"})
    for (int support = 0; support < 8; ++support) {
      INFO(name, " from support ", support);
      Solution s;
      s.z = Vector{double(support & 1), double(support >> 1 & 1), double(support >> 2 & 1)};
      CHECK(make_solver(name)->solve(p, s, Start::warm).status == Status::solved);
      CHECK((s.z.array() - 1.0 / 3).abs().maxCoeff() < 1e-14);
    }
}

TEST_CASE("string over an obstacle, sparse: the exact contact set (from far in a number of iterations that grows)") {
  const Lcp p = string_on_obstacle(256);
  for (const std::string name : {"block-pivot:coarse_start=0", "newton-min:coarse_start=0", "newton-fb"}) {
    INFO(name);
    Solution s;
    CHECK(make_solver(name)->solve(p, s).status == Status::solved);
    MESSAGE(name << ": " << s.iterations << " iterations, residual " << s.residual);
    for (const Index i : {0, 31, 60}) {  // u + gap = 4 (x − a)² left of a = 1/4
      const double x = static_cast<double>(i + 1) / 256;
      CHECK(s.z[i] == doctest::Approx(4 * (x - 0.25) * (x - 0.25)).epsilon(1e-6));
    }
    CHECK(s.z[127] == 0);
  }
}

TEST_CASE("string over an obstacle: from coarse problems a few iterations, whatever its length") {
  for (const std::string name : {"block-pivot", "newton-min"})
    for (const Index n : {127, 1023, 16383}) {
      INFO(name, ", n = ", n);
      Solution s;
      CHECK(make_solver(name)->solve(string_on_obstacle(n + 1), s).status == Status::solved);
      CHECK(s.iterations <= 4);
      CHECK(s.z[(n + 1) / 4 - 2] > 0);  // the last free node
      CHECK(s.z[(n + 1) / 4] == 0);
    }
}

TEST_CASE("sparse M-matrices with boxes and free rows, unsymmetric too: the coarse start changes no answer") {
  Random random(23);
  for (int trial = 0; trial < 60; ++trial) {
    const int n = random.integer(64, 300);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (int k = 0; k < 3 * n; ++k) {
      const int i = random.integer(0, n - 1), j = random.integer(0, n - 1);
      if (i == j) continue;
      A(i, j) = -random.uniform(0.0, 1.0);
      if (trial % 2 == 0) A(j, i) = A(i, j);
    }
    A.diagonal() = -A.rowwise().sum();
    A.diagonal().array() += 0.01;
    Lcp p = Lcp::standard(RowSparse::from(Eigen::SparseMatrix<double, Eigen::RowMajor>(A.sparseView())),
                          Vector(Eigen::VectorXd::Zero(n)));
    for (Index i = 0; i < n; ++i) {
      p.b[i] = random.normal();
      const int kind = random.integer(0, 3);
      if (kind == 1) p.hi[i] = random.uniform(0.0, 1.0);
      if (kind == 2) p.lo[i] = -kInf;
    }
    for (const std::string name : {"block-pivot", "newton-min"}) {
      INFO(name, ", trial ", trial, ", n = ", n);
      Solution s, plain;
      CHECK(make_solver(name)->solve(p, s).status == Status::solved);
      CHECK(make_solver(name + ":coarse_start=0")->solve(p, plain).status == Status::solved);
      CHECK((s.z - plain.z).lpNorm<Eigen::Infinity>() <= 1e-9 * (1 + plain.z.lpNorm<Eigen::Infinity>()));
    }
  }
}

TEST_CASE("random positive definite problems, boxes too: all four agree with Lemke") {
  Random random(21);
  for (int trial = 0; trial < 60; ++trial) {
    Lcp p = random_spd_problem(random.integer(1, 30), random);
    if (trial % 2 == 1)
      for (Index i = 0; i < p.size(); i += 2) p.hi[i] = random.uniform(0.0, 1.0);
    Solution expected, s;
    REQUIRE(make_solver("lemke")->solve(p, expected).status == Status::solved);
    for (const std::string name : {"block-pivot", "newton-min", "newton-fb", "murty"}) {
      INFO(name, ", trial ", trial);
      CHECK(make_solver(name)->solve(p, s).status == Status::solved);
      CHECK((s.w - expected.w).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + p.b.lpNorm<Eigen::Infinity>()));
    }
  }
}

TEST_CASE("contact problems with friction: the Newtons' answers stand, failures are honest") {
  Random random(22);
  for (const std::string name : {"newton-min", "newton-fb"}) {
    int solved = 0;
    for (int trial = 0; trial < 100; ++trial) {
      const Lcp p = random_contact_problem(random.integer(1, 8), 12, 0.5, random);
      Solution s;
      make_solver(name)->solve(p, s);
      if (s.status != Status::solved) continue;
      ++solved;
      CHECK(independent_residual(p, s.z) < 1e-8 * (1 + p.b.lpNorm<Eigen::Infinity>()));
    }
    MESSAGE(name << " solves " << solved << " of 100");
    CHECK(solved >= (name == "newton-fb" ? 50 : 1));
  }
}
