// Principal pivoting: dantzig, and what it shares with the other pivoting and active-set methods.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/pivoting/dantzig.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/judge.h"

using namespace orthant;

TEST_CASE("redundant contacts: dantzig solves random rank-deficient symmetric problems, to rounding") {
  Random random(51);
  Dantzig solver;
  Solution s;
  for (int trial = 0; trial < 400; ++trial) {
    const Index n = random.integer(1, 40), rank = random.integer(0, static_cast<int>(n));
    Eigen::MatrixXd B(rank, n);
    for (double& entry : B.reshaped()) entry = random.normal();
    if (rank > 0 && n > 2) B.col(n - 1) = B.col(0);  // a contact twice
    const Eigen::MatrixXd A = B.transpose() * B;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n), w = z;
    for (Index i = 0; i < n; ++i) {
      const int side = random.integer(0, 2);  // 2: degenerate
      if (side == 0) z[i] = random.uniform(0.1, 1.0);
      if (side == 1) w[i] = random.uniform(0.1, 1.0);
    }
    const Lcp p = Lcp::standard(DenseMatrix(A), Vector(w - A * z));
    solver.solve(p, s);
    INFO("trial ", trial, ", n = ", n, ", rank ", rank, ": ", name(s.status));
    REQUIRE(s.status == Status::solved);
    CHECK(independent_residual(p, s.z) < 1e-13);
    CHECK((s.w - w).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + p.b.lpNorm<Eigen::Infinity>()));  // w is unique
  }
}

TEST_CASE("hyperstatic table: dantzig carries it on any number of legs, in any order") {
  Random random(52);
  Dantzig solver;
  Solution s;
  for (int trial = 0; trial < 100; ++trial) {
    // A plate of mass 1, unit inertias, on legs at (x, y): W's rows are (1, y, −x); the load acts inside the legs.
    const Index legs = random.integer(4, 24);
    Eigen::MatrixXd W(legs, 3);
    Eigen::Vector3d load = Eigen::Vector3d::Zero();
    for (Index i = 0; i < legs; ++i) {
      W.row(i) << 1, random.integer(-4, 4), random.integer(-4, 4);
      load += random.integer(0, 3) * W.row(i).transpose();  // some combination of legs can bear it
    }
    const Lcp p = Lcp::standard(DenseMatrix(W * W.transpose()), Vector(-W * load));
    solver.solve(p, s);
    INFO("trial ", trial);
    REQUIRE(s.status == Status::solved);
    CHECK((W.transpose() * s.z - load).lpNorm<Eigen::Infinity>() <= 1e-12 * (1 + load.lpNorm<Eigen::Infinity>()));
    CHECK(s.z.minCoeff() >= 0);
  }
}

TEST_CASE("monotone problems, degenerate and rank deficient: dantzig solves all") {
  Random random(300);
  Dantzig solver;
  Solution s;
  int pivots = 0, rounded = 0;
  for (int k = 0; k < 2000; ++k) {
    const Index n = random.integer(1, 12), rank = random.integer(0, static_cast<int>(n));
    const Known known = planted_problem(n, rank, random.integer(0, static_cast<int>(n)), random);
    solver.solve(known.problem, s);
    INFO("problem ", k, ", n = ", n, ": ", name(s.status));
    REQUIRE(has_answer(s.status));
    rounded += s.status == Status::rounded;
    REQUIRE(independent_residual(known.problem, s.z) < 1e-12);
    pivots = std::max(pivots, s.iterations);
  }
  CHECK(rounded <= 10);  // b is a sum that cancels: rows with a β of rounding
  CHECK(pivots <= 60);
}

TEST_CASE("monotone problems with boxes and free rows: dantzig solves or proves, as Lemke does") {
  Random random(53);
  Dantzig solver;
  Solution s, truth;
  int solved = 0, infeasible = 0;
  for (int k = 0; k < 2000; ++k) {
    const Index n = random.integer(1, 8), rank = random.integer(0, static_cast<int>(n));
    Lcp p = planted_problem(n, rank, n, random).problem;
    for (Index i = 0; i < n; ++i) {
      const int kind = random.integer(0, 5);
      if (kind == 0) p.lo[i] = -kInf;
      if (kind == 1) p.hi[i] = random.integer(0, 2);
      if (kind == 2) p.lo[i] = -kInf, p.hi[i] = random.integer(-1, 1);
    }
    make_solver("lemke")->solve(p, truth);
    solver.solve(p, s);
    INFO("problem ", k, ", n = ", n, ": ", name(s.status), ", Lemke ", name(truth.status));
    REQUIRE(s.status == truth.status);
    solved += s.status == Status::solved;
    infeasible += s.status == Status::infeasible;
    if (s.status == Status::solved) CHECK(independent_residual(p, s.z) < 1e-12);
  }
  CHECK(solved > 500);
  CHECK(infeasible > 100);
}

TEST_CASE("contact problems with friction: dantzig's answers stand, failures are honest") {
  Random random(57);
  Dantzig solver;
  int solved = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Lcp p = random_contact_problem(random.integer(1, 8), 12, 0.5, random);
    Solution s;
    solver.solve(p, s);
    if (s.status != Status::solved) continue;
    ++solved;
    CHECK(independent_residual(p, s.z) < 1e-12);
  }
  MESSAGE("dantzig solves ", solved, " of 500");
  CHECK(solved >= 250);
}

TEST_CASE("free rows with a zero diagonal: equations in any order") {
  Eigen::Matrix4d A;  // w = A z + b = 0: a saddle point and a swap
  A << 0, 0, 1, 1, 0, 0, 2, -1, -1, -2, 0, 0, -1, 1, 0, 0;
  const Eigen::Vector4d z(3, -1, 2, 5);
  Lcp p = Lcp::standard(DenseMatrix(A), Vector(-A * z));
  p.lo.setConstant(-kInf);
  for (const std::string name : {"murty", "dantzig"}) {
    INFO(name);
    Solution s;
    CHECK(make_solver(name)->solve(p, s).status == Status::solved);
    CHECK((s.z - z).lpNorm<Eigen::Infinity>() == 0);
  }
}

TEST_CASE("dantzig: equations go first; the rest may be a P-matrix where the whole is not") {
  DenseMatrix A(Eigen::Matrix3d{{0, 0, -2}, {-1, 0, -3}, {3, 1, 1}});  // without its last row and column: (6, 2; 8, 3)
  Lcp p = Lcp::standard(A, Vector{-2, 2, 3});
  p.lo[2] = -kInf;
  Dantzig solver;
  Solution s;
  CHECK(solver.solve(p, s).status == Status::solved);
  CHECK((s.z - Eigen::Vector3d(0, 0, -3)).lpNorm<Eigen::Infinity>() == 0);

  Random random(7);
  const auto normal = [&](Index rows, Index columns) {
    Eigen::MatrixXd B(rows, columns);
    for (double& entry : B.reshaped()) entry = random.normal();
    return B;
  };
  int solved = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Index equations = random.integer(1, 12), contacts = random.integer(1, 12);
    const Eigen::MatrixXd F = normal(contacts, contacts), R = normal(contacts, equations),
                          D = normal(equations, contacts);
    const Eigen::MatrixXd b = normal(contacts + equations, 1);
    Eigen::MatrixXd B(contacts + equations, contacts + equations);
    B << F.transpose() * F + 0.1 * Eigen::MatrixXd::Identity(contacts, contacts) + R * D, R, D,
        Eigen::MatrixXd::Identity(equations, equations);
    p = Lcp::standard(DenseMatrix(B), Vector(b));
    p.lo.tail(equations).setConstant(-kInf);
    if (solver.solve(p, s).status != Status::solved) continue;
    ++solved;
    CHECK(independent_residual(p, s.z) < 1e-12);
  }
  MESSAGE("dantzig solves ", solved, " of 500");
  CHECK(solved >= 410);
}

TEST_CASE("Murty's problem of 60 rows: the least-index rules end on their limit and say so") {
  const Lcp p = murty_problem(60, true);
  Solution s;
  for (const std::string name : {"murty", "dantzig"}) {
    CHECK(make_solver(name + ":max_pivots=20000")->solve(p, s).status == Status::iteration_limit);
    CHECK(s.iterations == 20000);
  }
}

TEST_CASE("dantzig: rows that go from bound to bound without a pivot come to an end") {
  DenseMatrix A(Eigen::MatrixXd{{1.051899045809419e-250, -9.17982169270183e-251},
                                {-9.17982169270183e-251, 9.87716023861245e-251}});
  Lcp problem = Lcp::standard(A, Vector{3.726851886426955e-271, 6.796236466334077e-271});
  problem.lo = Vector{-kInf, -2};
  problem.hi = Vector{kInf, 2};
  const auto solver = make_solver("dantzig");
  solver->set_time_limit(5);
  Solution s;
  solver->solve(problem, s);  // returns
  CHECK(s.status != Status::infeasible);
}
