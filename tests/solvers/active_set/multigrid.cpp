// Multigrid: cycles that do not grow with the grid, the levels' algebra, descent.
#include <orthant/solvers/active_set/multigrid.h>

#include <orthant/core/lcp/problems/american_put.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <Eigen/QR>

#include "tests/support/judge.h"

using namespace orthant;

namespace {

Solution by(const std::string& spec, const Lcp& problem) {
  const auto solver = make_solver(spec);
  solver->set_proof_search(false);
  Solution s;
  solver->solve(problem, s);
  return s;
}

/// Rows and columns that are held taken out, the others dense.
Eigen::MatrixXd truncated(const RowSparse& A, const std::vector<char>& held) {
  Eigen::MatrixXd T(A.view());
  for (Index i = 0; i < A.rows; ++i)
    if (held[at(i)] != 0) T.row(i).setZero(), T.col(i).setZero();
  return T;
}

}  // namespace

TEST_CASE("multigrid: as many cycles on fine grids as on coarse ones, no factorization, block pivoting's answer") {
  const auto most_cycles = [](const std::vector<Lcp>& grids) {
    int most = 0;
    for (const Lcp& problem : grids) {
      const Solution s = by("multigrid", problem), exact = by("block-pivot", problem);
      INFO(problem.size(), " rows: ", name(s.status), " after ", s.iterations);
      REQUIRE(s.status == Status::solved);
      REQUIRE(exact.status == Status::solved);
      CHECK(s.factorizations == 0);
      CHECK((s.z - exact.z).lpNorm<Eigen::Infinity>() < 1e-8 * (1 + exact.z.lpNorm<Eigen::Infinity>()));
      most = std::max(most, s.iterations);
    }
    return most;
  };
  CHECK(most_cycles({ball_obstacle(16).problem, ball_obstacle(64).problem, ball_obstacle(128).problem}) <= 20);
  CHECK(most_cycles({journal_bearing(15, 15), journal_bearing(63, 63), journal_bearing(20, 200)}) <= 20);
  CHECK(most_cycles({space_obstacle(8).problem, space_obstacle(16).problem}) <= 25);
  CHECK(most_cycles({elastic_plastic_torsion(15, 15), elastic_plastic_torsion(63, 63)}) <= 25);
  CHECK(most_cycles({string_on_obstacle(64), string_on_obstacle(1000)}) <= 25);
  AmericanBasket basket;
  const Vector payoff = basket.payoff();
  CHECK(most_cycles({american_basket_step(basket, payoff, 0.1)}) <= 20);
}

TEST_CASE("multigrid: a tolerance below rounding ends soon, and the judge says how near z is") {
  for (const Index side : {63, 127}) {
    const Lcp problem = journal_bearing(side, side);
    const Solution usual = by("multigrid", problem), beyond = by("multigrid:tolerance=1e-18", problem);
    INFO(side, ": ", name(beyond.status), " after ", beyond.iterations, ", at 1e-10 ", usual.iterations);
    REQUIRE(usual.status == Status::solved);
    CHECK(beyond.iterations <= usual.iterations + 20);  // of 500 that it may take
    CHECK((beyond.status == Status::rounded || beyond.status == Status::stalled));
    CHECK((beyond.z - usual.z).lpNorm<Eigen::Infinity>() <= 1e-8 * usual.z.lpNorm<Eigen::Infinity>());
  }
}

TEST_CASE("multigrid: boxes and free rows, sparse, dense and as an operator, agree with Lemke") {
  Random random(40);
  for (int trial = 0; trial < 12; ++trial) {
    Lcp p = random_spd_problem(random.integer(2, 30), random);
    for (Index i = 0; i < p.size(); i += 3) p.lo[i] = -0.1, p.hi[i] = random.uniform(0, 0.2);
    for (Index i = 1; i < p.size(); i += 4) p.lo[i] = -kInf;
    const Solution exact = by("lemke", p);
    REQUIRE(exact.status == Status::solved);
    for (const Lcp& stored : {p, as_sparse(p)}) {
      const Solution s = by("multigrid", stored);
      REQUIRE(s.status == Status::solved);
      CHECK((s.z - exact.z).lpNorm<Eigen::Infinity>() <= 1e-6 * (1 + exact.z.lpNorm<Eigen::Infinity>()));
    }
  }
  const Lcp contacts = random_contact_problem(3, 8, 0.5, random);
  CHECK(by("multigrid", contacts).status == Status::unsupported);
}

TEST_CASE("multigrid: no cycle raises the form that a symmetric problem minimizes") {
  const Lcp p = elastic_plastic_torsion(40, 30);
  double before = kInf;
  for (int cycles = 1; cycles < 10; ++cycles) {
    const Solution s = by("multigrid:nested_cycles=0,tolerance=1e-14,max_cycles=" + std::to_string(cycles), p);
    const double energy = 0.5 * s.z.dot(s.w) + 0.5 * s.z.dot(p.b);  // w = A z + b
    CHECK(energy <= before + 1e-14);
    before = energy;
  }
}

TEST_CASE("levels of multigrid: Galerkin products, truncated anew or from the last ones, held rows stay") {
  const Lcp p = ball_obstacle(20).problem;
  const auto& A = std::get<RowSparse>(p.A);
  const Budget unlimited;
  CoarseLevels levels;
  levels.build(A, unlimited);
  REQUIRE(levels.count() > 3);
  // P from what interpolation makes of unit vectors; Pᵀ A P by Eigen.
  const Index n = A.rows, coarse = levels.matrix(1).rows;
  Eigen::MatrixXd P(n, coarse);
  for (Index j = 0; j < coarse; ++j) {
    Vector unit(Eigen::VectorXd::Unit(coarse, j)), column;
    levels.interpolate(0, unit, column);
    P.col(j) = column;
    CHECK(column[levels.coarse(0)[at(j)]] == 1);
  }
  const Eigen::MatrixXd product = P.transpose() * (A.view() * P);
  CHECK((Eigen::MatrixXd(levels.matrix(1).view()) - product).cwiseAbs().maxCoeff() <
        1e-12 * product.cwiseAbs().maxCoeff());

  Random random(41);
  std::vector<char> held(at(n), 0);
  Vector w, c, again;
  w.resize(n);
  CoarseLevels fresh;
  fresh.build(A, unlimited);
  for (int change = 0; change < 5; ++change) {
    for (Index i = 0; i < n; ++i) {
      w[i] = random.normal();
      if (random.uniform() < (change == 0 ? 0.3 : 0.02)) held[at(i)] ^= 1;
    }
    levels.truncate(0, held);
    levels.correct(0, w, c);
    fresh.build(A, unlimited);
    fresh.truncate(0, held);
    fresh.correct(0, w, again);
    CHECK(c == again);
    for (Index i = 0; i < n; ++i)
      if (held[at(i)] != 0) CHECK(c[i] == 0);
    // The correction lies in the range of the truncated P, and is nearly the best there in the energy of T.
    const Eigen::MatrixXd T = truncated(A, held);
    Eigen::VectorXd load = -w;
    for (Index i = 0; i < n; ++i)
      if (held[at(i)] != 0) load[i] = 0;
    const Eigen::MatrixXd coarse_T = P.transpose() * T * P;
    const Eigen::VectorXd best = P * coarse_T.completeOrthogonalDecomposition().solve(P.transpose() * load);
    const auto energy = [&](const Eigen::VectorXd& x) { return 0.5 * x.dot(T * x) - x.dot(load); };
    CHECK(energy(c) < 0.95 * energy(best));
    CHECK(energy(c) >= energy(best) * (1 + 1e-9));
  }
}
