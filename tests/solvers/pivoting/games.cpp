// Bimatrix games: equilibria in game terms, by every label and on from each equilibrium found.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/families.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/pivoting/extreme_equilibria.h>
#include <orthant/solvers/pivoting/lemke_howson.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/support/judge.h"

using namespace orthant;

namespace {

Lcp as_lcp(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  const Index m = A.rows(), k = A.cols();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(m + k, m + k);
  M.topRightCorner(m, k) = A;
  M.bottomLeftCorner(k, m) = B.transpose();
  return Lcp::standard(DenseMatrix(M), Vector(Eigen::VectorXd::Constant(m + k, -1)));
}

/// No pure strategy costs a player less than the equilibrium does.
double regret(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Equilibrium& e) {
  return std::max(e.cost_1 - (A * e.y).minCoeff(), e.cost_2 - (B.transpose() * e.x).minCoeff());
}

}  // namespace

TEST_CASE("coordination game: all three equilibria are found") {
  Eigen::Matrix2d A;
  A << 10, 20, 30, 15;
  const auto found = lemke_howson_all(A, A);
  REQUIRE(found.size() == 3);
  const double expected[3][4] = {
      {0.1, 0, 0.1, 0}, {0, 1.0 / 15, 0, 1.0 / 15}, {1.0 / 30, 1.0 / 45, 1.0 / 90, 2.0 / 45}};
  for (const auto& z : expected) {
    const bool there = std::any_of(found.begin(), found.end(), [&](const Equilibrium& e) {
      Eigen::Vector4d w;
      w << e.x / e.cost_2, e.y / e.cost_1;
      return (w - Eigen::Vector4d(z[0], z[1], z[2], z[3])).lpNorm<Eigen::Infinity>() < 1e-14;
    });
    CHECK(there);
  }
}

TEST_CASE("rock, paper, scissors: the one equilibrium is uniform") {
  Eigen::Matrix3d A;
  A << 2, 3, 1, 1, 2, 3, 3, 1, 2;
  const auto found = lemke_howson_all(A, A.transpose());
  REQUIRE(found.size() == 1);
  CHECK((found[0].x.array() - 1.0 / 3).abs().maxCoeff() < 1e-15);
  CHECK((found[0].y.array() - 1.0 / 3).abs().maxCoeff() < 1e-15);
  CHECK(found[0].cost_1 == doctest::Approx(2));
}

TEST_CASE("random games: no player regrets, an odd number is found, the LCP is solved, all labels end") {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const int m = random.integer(1, 5), k = random.integer(1, 5);
    Eigen::MatrixXd A(m, k), B(m, k);
    for (double& a : A.reshaped()) a = random.uniform(1, 2);
    for (double& b : B.reshaped()) b = random.uniform(1, 2);
    const auto found = lemke_howson_all(A, B);
    CHECK(found.size() % 2 == 1);
    for (const Equilibrium& e : found) CHECK(regret(A, B, e) < 1e-12);
    const Lcp p = as_lcp(A, B);
    Solution s;
    CHECK(LemkeHowson().solve(p, s).status == Status::solved);
    CHECK(independent_residual(p, s.z) < 1e-12);
    for (int label = 0; label < m + k; ++label)
      CHECK(LemkeHowson({.label = label}).solve(p, s).status == Status::solved);
  }
}

TEST_CASE("degenerate games with tied costs end too") {
  Random random(8);
  for (int trial = 0; trial < 500; ++trial) {
    const int m = random.integer(1, 4), k = random.integer(1, 4);
    Eigen::MatrixXd A(m, k), B(m, k);
    for (double& a : A.reshaped()) a = random.integer(1, 2);
    for (double& b : B.reshaped()) b = random.integer(1, 2);
    for (int label = 0; label < m + k; ++label) CHECK(regret(A, B, lemke_howson(A, B, label)) < 1e-12);
  }
}

TEST_CASE("a degenerate game whose path is a circle, where ties are broken by the rows' order, ends") {
  Eigen::MatrixXd A(5, 6), B(5, 6);
  A << 2, 2, 3, 3, 3, 1, 3, 2, 1, 2, 1, 1, 1, 1, 1, 1, 3, 2, 2, 3, 1, 3, 1, 3, 3, 1, 2, 3, 3, 3;
  B << 1, 3, 3, 3, 1, 2, 2, 2, 3, 1, 3, 2, 3, 2, 1, 1, 3, 2, 1, 3, 3, 2, 1, 3, 2, 1, 2, 3, 3, 2;
  LemkeHowson solver({.label = 10});
  solver.set_time_limit(5);
  Solution s;
  CHECK(solver.solve(as_lcp(A, B), s).status == Status::solved);
  CHECK(s.iterations < 20);
}

TEST_CASE("costs that span 14 orders: a path that rounding leads in circles ends, as an error or by another label") {
  Eigen::MatrixXd A(4, 3), B(4, 3);
  A << 4.003196886895105e-05, 3.4935237190820044e-14, 9.716249388613802e-09, 3.1745406325510633e-08,
      1.5903659299516103e-11, 9.07735265604409e-13, 0.050270182264844934, 1.7657075465144793e-10,
      1.2097478722007392e-12, 5.145428642375642e-06, 1.168526158585295e-13, 2.499429929593835e-06;
  B << 2.8360064307056143e-11, 0.001335760600787293, 5.1290983341717834e-14, 1.7375286449946617e-05,
      3.6751888306841594e-14, 2.9026981390362076e-07, 1.1880673121838351e-11, 0.010199701885856994,
      1.6197824845587615e-14, 1.6964831962422275e-14, 0.003495965430226993, 5.566698767837042e-14;
  LemkeHowson solver;
  solver.set_time_limit(5);
  Solution s;
  solver.solve(as_lcp(A, B), s);
  CHECK(s.status != Status::time_limit);
  CHECK(s.iterations < 10000);
  int circles = 0, asked = 0;
  const auto stop = [&] { return ++asked > 1000000; };
  for (int label = 0; label < 7; ++label) {
    try {
      const Equilibrium e = lemke_howson(A, B, label, stop);
      CHECK(e.x.size() == 4);
    } catch (const std::runtime_error& error) {
      CHECK(std::string(error.what()).find("rounding leads the path") != std::string::npos);
      ++circles;
    }
  }
  CHECK(circles > 0);
  lemke_howson_all(A, B, stop);
  CHECK(asked < 100000);
}

TEST_CASE("another label's path answers if the first label's ends next to an equilibrium") {
  const Eigen::MatrixXd A{{2.0417512226993906e-07, 7.143456962073979e-07},
                          {4.358957119623648e-05, 1.352040713379342e-08},
                          {6.751009476282847e-08, 0.0016189547973605768}},
      B{{1.7738522867421598e-10, 3.949159172743295e-10},
        {0.13794789212027128, 6.19788382593039e-10},
        {9.693904656423093e-06, 1.8149675253872745e-06}};
  Solution s;
  CHECK(LemkeHowson({.label = 0}).solve(as_lcp(A, B), s).status == Status::stalled);
  REQUIRE(LemkeHowson().solve(as_lcp(A, B), s).status == Status::solved);
  CHECK(independent_residual(as_lcp(A, B), s.z) <= 1e-12);
}

TEST_CASE("large games: time limit, cancellation and log") {
  Random random(3);
  Eigen::MatrixXd A(150, 150), B(150, 150);
  for (double& cost : A.reshaped()) cost = random.uniform(1, 2);
  for (double& cost : B.reshaped()) cost = random.uniform(1, 2);
  const Lcp p = as_lcp(A, B);
  Solution s;
  LemkeHowson solver;
  solver.set_time_limit(1e-4);
  CHECK(solver.solve(p, s).status == Status::time_limit);
  solver.set_time_limit(kInf);
  const std::atomic<bool> cancel = true;
  solver.set_cancel(&cancel);
  CHECK(solver.solve(p, s).status == Status::cancelled);
  solver.set_cancel(nullptr);
  IterationLog log;
  solver.set_log(&log);
  const Eigen::Matrix2d C{{10, 20}, {30, 15}};
  solver.solve(as_lcp(C, C), s);
  CHECK(log.size() == static_cast<std::size_t>(s.iterations));
  CHECK(s.iterations > 0);
}

TEST_CASE("matrices that are not a game are refused with a reason") {
  const Eigen::Matrix2d one = Eigen::Matrix2d::Ones();
  CHECK_THROWS_WITH_AS(lemke_howson(one, Eigen::MatrixXd::Ones(2, 3), 0), doctest::Contains("same shape"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(lemke_howson(one, one, 4), doctest::Contains("[0, 3]"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(lemke_howson(one * std::nan(""), one, 0), doctest::Contains("finite"), std::invalid_argument);
  CHECK(LemkeHowson().why_not(Lcp::standard(DenseMatrix(one), Vector{-1, -1})).find("no bimatrix") !=
        std::string::npos);
  CHECK(LemkeHowson().why_not(as_lcp(one, -one)).find("> 0") != std::string::npos);
  CHECK(LemkeHowson().why_not(as_lcp(one, one)).empty());
}

TEST_CASE("a game is known in whatever order its strategies stand") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Lcp game = find_family("bimatrix")->make(40, 0, seed).problem;
    const auto& M = std::get<DenseMatrix>(game.A);
    std::vector<Index> order;
    for (Index i = 0; i < game.size(); ++i) order.push_back((7 * i + 3) % game.size());  // 7 and 40 share no factor
    REQUIRE(game.size() == 40);
    const Lcp mixed = Lcp::standard(DenseMatrix(M(order, order).eval()), Vector(game.b));
    Solution a, b;
    REQUIRE(make_solver("lemke-howson")->solve(game, a).status == Status::solved);
    for (const char* spec : {"lemke-howson", "auto"})
      CHECK(make_solver(spec)->solve(mixed, b).status == Status::solved);
    CHECK(independent_residual(mixed, b.z) <= 1e-12);
  }
}

TEST_CASE("stopped: no equilibrium, those found so far, or solutions that are marked as not all") {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(6, 6), B = Eigen::MatrixXd::Random(6, 6);
  int asked = 0;
  const auto after = [&](int patience) { return [&asked, patience] { return ++asked > patience; }; };
  CHECK(lemke_howson(A, B, 0, after(1)).x.size() == 0);
  CHECK(lemke_howson(A, B, 0, [] { return false; }).x.size() == 6);
  asked = 0;
  CHECK(lemke_howson_all(A, B, after(0)).empty());
  asked = 0;
  for (const Equilibrium& e : lemke_howson_all(A, B, after(30))) CHECK(regret(A, B, e) < 1e-12);

  const Lcp corners = Lcp::standard(DenseMatrix(-Eigen::MatrixXd::Identity(8, 8)), Vector(Eigen::VectorXd::Ones(8)));
  const SolutionSet every = enumerate_solutions(corners);
  CHECK((every.complete && every.isolated.size() == 256));
  CHECK(!enumerate_solutions(corners, [] { return true; }).complete);
}

TEST_CASE("extreme equilibria: a degenerate game has all eight, each exact") {
  Eigen::MatrixXd A(3, 5), B(3, 5);  // after a public bug report, Nashpy#82: players minimize
  A << 0, 0, 6, 0, 0, 0, 0, 3, 2, 1, 4, 3, 0, 0, 1;
  B << 3, 0, 2, 1, 0, 0, 2, 0, 0, 4, 4, 0, 2, 4, 4;
  const double expected[8][8] = {{1, 0, 0, 0, 1, 0, 0, 0},
                                 {1, 0, 0, 0, 0, 0, 0, 1},
                                 {2. / 3, 1. / 3, 0, 0, 1, 0, 0, 0},
                                 {1. / 3, 1. / 2, 1. / 6, 0, 4. / 9, 2. / 9, 1. / 3, 0},
                                 {0, 1. / 2, 1. / 2, 0, 1. / 2, 1. / 2, 0, 0},
                                 {0, 1, 0, 3. / 7, 0, 4. / 7, 0, 0},
                                 {0, 1, 0, 1, 0, 0, 0, 0},
                                 {0, 1, 0, 3. / 8, 0, 1. / 4, 3. / 8, 0}};
  const auto found = extreme_equilibria(A, B);
  CHECK(found.complete);
  REQUIRE(found.all.size() == 8);
  for (const Equilibrium& e : found.all) {
    Eigen::VectorXd z(8);
    z << e.x, e.y;
    const auto is = [&](const double(&row)[8]) {
      return (z - Eigen::Map<const Eigen::VectorXd>(row, 8)).lpNorm<Eigen::Infinity>() < 1e-15;
    };
    CHECK(std::any_of(std::begin(expected), std::end(expected), is));
    CHECK(e.regret == 0);
    CHECK(std::abs(regret(A, B, e)) < 1e-15);
  }
  CHECK(found.components == 4);  // three share x = (0, 1, 0), three are joined by (1, 0, 0) and the second of y
  CHECK(extreme_equilibria(A, B, [] { return true; }).complete == false);
  CHECK_THROWS_AS(extreme_equilibria(A, B.leftCols(4)), std::invalid_argument);
}

TEST_CASE("extreme equilibria of random games: those that every choice of sides gives") {
  Random random(11);
  for (int trial = 0; trial < 40; ++trial) {
    const Index m = 1 + trial % 3, k = 1 + trial % 4;
    const auto costs = [&] {
      Eigen::MatrixXd C(m, k);
      for (double& c : C.reshaped()) c = random.integer(1, 3);  // few values: many are degenerate
      return C;
    };
    const Eigen::MatrixXd A = costs(), B = costs();
    const SolutionSet set = enumerate_solutions(as_lcp(A, B));
    std::vector<Eigen::VectorXd> points = {};
    const auto add = [&](const Vector& z) {  // scaled to strategies; vertices of faces are extreme
      const Eigen::VectorXd x = z.head(m), y = z.tail(k);
      if (x.sum() == 0 || y.sum() == 0) return;
      Eigen::VectorXd point(m + k);
      point << x / x.sum(), y / y.sum();
      for (const auto& other : points)
        if ((other - point).lpNorm<Eigen::Infinity>() < 1e-12) return;
      points.push_back(point);
    };
    for (const Vector& z : set.isolated) add(z);
    for (const SolutionFace& face : set.faces)
      for (const Vector& z : face.vertices) add(z);
    const auto found = extreme_equilibria(A, B);
    CHECK(found.all.size() == points.size());
    for (const Equilibrium& e : found.all) {
      Eigen::VectorXd z(m + k);
      z << e.x, e.y;
      CHECK(std::any_of(points.begin(), points.end(),
                        [&](const auto& point) { return (point - z).template lpNorm<Eigen::Infinity>() < 1e-12; }));
    }
  }
}
