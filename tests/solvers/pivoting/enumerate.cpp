// The oracle: complete solution sets, known by hand and by brute force in rationals.
#include <orthant/core/lcp/judge/exact.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/pivoting/enumerate.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/judge.h"

using namespace orthant;
using exact::Rational;

namespace {

Lcp lcp(std::initializer_list<double> rows, const Vector& q) {
  Eigen::MatrixXd M(q.size(), q.size());
  std::copy(rows.begin(), rows.end(), M.reshaped<Eigen::RowMajor>().begin());
  return Lcp::standard(DenseMatrix(M), q);
}

bool has(const std::vector<Vector>& all, const Vector& z) {
  return std::any_of(all.begin(), all.end(), [&](const Vector& y) { return y == z; });
}

/// A point of the face: random convex weights on its vertices, random multiples of directions and lines.
Vector inside(const SolutionFace& face, Random& random) {
  Vector z = face.vertices.front();
  z.setZero();
  double total = 0;
  for (const Vector& v : face.vertices) {
    const double weight = random.uniform();
    z += weight * v, total += weight;
  }
  z /= total;
  for (const Vector& d : face.directions) z += random.uniform(0, 3) * d;
  for (const Vector& d : face.lines) z += random.uniform(-3, 3) * d;
  return z;
}

/// Rational points of the solution set, found without the enumerator: every z on a grid of halves in [0, 3]ⁿ.
std::vector<Vector> grid_solutions(const Lcp& p) {
  const Index n = p.size();
  const auto& M = std::get<DenseMatrix>(p.A);
  std::vector<Vector> found;
  Vector z = p.b;
  const auto points = static_cast<long>(std::pow(7, n));
  for (long k = 0; k < points; ++k) {
    long rest = k;
    for (double& value : z) value = 0.5 * static_cast<double>(rest % 7), rest /= 7;
    const Eigen::VectorXd w = M * z + p.b;  // halves of small integers: exact
    if (w.minCoeff() >= 0 && w.cwiseProduct(z).isZero(0)) found.push_back(z);
  }
  return found;
}

/// z in the hull of the vertices + directions: exact, by the cone that they span.
bool member(const SolutionFace& face, const Vector& z) {
  // Σ a_i v_i + Σ b_j d_j = z, Σ a_i = 1: feasible ⟺ the cone of (a, b, τ) ≥ 0 with Σ … − τ z = 0 has a ray with τ > 0.
  const std::size_t count = face.vertices.size() + face.directions.size(), n = static_cast<std::size_t>(z.size());
  exact::Table G;
  for (std::size_t k = 0; k <= count; ++k) {
    G.emplace_back(count + 1);
    G.back()[k] = 1;
  }
  for (std::size_t i = 0; i <= n; ++i) {  // the last equation: Σ a = τ
    exact::Row row(count + 1);
    for (std::size_t k = 0; k < count; ++k) {
      const bool vertex = k < face.vertices.size();
      const Vector& g = vertex ? face.vertices[k] : face.directions[k - face.vertices.size()];
      row[k] = i < n ? g[static_cast<Index>(i)] : static_cast<double>(vertex);
    }
    row[count] = i < n ? -z[static_cast<Index>(i)] : -1;
    G.push_back(row);
    for (Rational& entry : row) entry = -entry;
    G.push_back(row);
  }
  const auto rays = exact::cone(G, count + 1).rays;
  return std::any_of(rays.begin(), rays.end(), [&](const exact::Row& ray) { return ray[count] > 0; });
}

}  // namespace

TEST_CASE("segments and rays of solutions: dimension, vertices, directions") {
  auto set = enumerate_solutions(lcp({1, 1, 1, 1}, {-1, -1}));
  CHECK(set.isolated.empty());
  REQUIRE(set.faces.size() == 1);
  CHECK(set.faces[0].dimension == 1);
  CHECK(set.faces[0].vertices.size() == 2);
  CHECK(has(set.faces[0].vertices, {1, 0}));
  CHECK(has(set.faces[0].vertices, {0, 1}));
  CHECK(set.faces[0].directions.empty());

  set = enumerate_solutions(lcp({1, -1, -1, 1}, {1, -1}));
  CHECK(set.isolated.empty());
  REQUIRE(set.faces.size() == 1);
  CHECK(set.faces[0].vertices == std::vector<Vector>{{0, 1}});
  CHECK(set.faces[0].directions == std::vector<Vector>{{1, 1}});

  // A solution that no regular basis has: w₁ = −100 z₁ + z₂ − 1, w₂ = 0.
  const Lcp singular = lcp({-100, 1, 0, 0}, {-1, 0});
  set = enumerate_solutions(singular);
  CHECK(set.isolated.empty());
  CHECK(set.faces.size() == 2);  // z₁ = 0, z₂ ≥ 1, and z₂ = 1 + 100 z₁
  Solution s;
  CHECK(Enumerate().solve(singular, s).status == Status::solved);
  CHECK(s.z == Vector{0, 1});
}

TEST_CASE("isolated solutions: four corners, three equilibria, one") {
  const auto corners = enumerate_solutions(lcp({-1, 0, 0, -1}, {1, 1}));
  CHECK(corners.faces.empty());
  CHECK(corners.isolated.size() == 4);
  for (const Vector& z : {Vector{0, 0}, Vector{1, 0}, Vector{0, 1}, Vector{1, 1}}) CHECK(has(corners.isolated, z));

  const auto game = enumerate_solutions(
      lcp({0, 0, 10, 20, 0, 0, 30, 15, 10, 30, 0, 0, 20, 15, 0, 0}, Vector(-Eigen::VectorXd::Ones(4))));
  CHECK(game.faces.empty());
  CHECK(game.isolated.size() == 3);
  for (const Vector& z :
       {Vector{0.1, 0, 0.1, 0}, Vector{0, 1. / 15, 0, 1. / 15}, Vector{1. / 30, 1. / 45, 1. / 90, 2. / 45}})
    CHECK(has(game.isolated, z));

  for (const Known& k : known_problems()) {
    if (!Enumerate().why_not(k.problem).empty()) continue;
    INFO(k.name);
    const auto set = enumerate_solutions(k.problem);
    CHECK((set.isolated.empty() && set.faces.empty()) == (k.z.size() == 0));
    if (k.answer == Answer::unique) {
      CHECK(set.faces.empty());
      REQUIRE(set.isolated.size() == 1);
      CHECK((set.isolated[0] - k.z).lpNorm<Eigen::Infinity>() <=
            std::max(k.accuracy, 4e-16) * k.z.lpNorm<Eigen::Infinity>());
    }
  }
}

TEST_CASE("one row: every sign of A and b has its set") {
  const auto scalar = [](double a, double b) { return enumerate_solutions(lcp({a}, {b})); };
  CHECK(scalar(2, -1).isolated == std::vector<Vector>{{0.5}});
  CHECK(scalar(2, 1).isolated == std::vector<Vector>{{0}});
  CHECK(scalar(-2, 1).isolated == std::vector<Vector>{{0}, {0.5}});
  CHECK(scalar(-2, -1).isolated.empty());
  CHECK(scalar(0, -1).isolated.empty());
  CHECK(scalar(0, 1).isolated == std::vector<Vector>{{0}});
  const auto all = scalar(0, 0);  // every z ≥ 0
  CHECK(all.isolated.empty());
  REQUIRE(all.faces.size() == 1);
  CHECK(all.faces[0].vertices == std::vector<Vector>{{0}});
  CHECK(all.faces[0].directions == std::vector<Vector>{{1}});
}

TEST_CASE("isolated points next to faces; free rows, boxes, friction") {
  // Row 1 has two solutions, 0 and 1; rows 2 and 3 a segment: two faces. With z₁ = 1 moving the segment's w off 0, one.
  auto set = enumerate_solutions(lcp({-1, 0, 0, 1, 1, 1, 1, 1, 1}, {1, -1, -1}));
  REQUIRE(set.faces.size() == 1);
  CHECK(set.isolated == std::vector<Vector>{{1, 0, 0}});
  CHECK(set.faces[0].dimension == 1);

  Lcp free = lcp({0, 0, 0, 1}, {0, -1});  // nothing determines z₁
  free.lo[0] = -kInf;
  set = enumerate_solutions(free);
  REQUIRE(set.faces.size() == 1);
  CHECK(set.faces[0].vertices == std::vector<Vector>{{0, 1}});
  CHECK(set.faces[0].lines == std::vector<Vector>{{1, 0}});

  Lcp box = lcp({-1}, {0.5});  // w = ½ − z on [0, 2]: at 0, ½ and 2
  box.hi[0] = 2;
  CHECK(enumerate_solutions(box).isolated == std::vector<Vector>{{0}, {0.5}, {2}});
  box.b[0] = 0, std::get<DenseMatrix>(box.A)(0, 0) = 0;
  set = enumerate_solutions(box);
  REQUIRE(set.faces.size() == 1);
  CHECK(set.faces[0].vertices.size() == 2);
  CHECK((has(set.faces[0].vertices, {0}) && has(set.faces[0].vertices, {2})));
  box.hi[0] = 0;  // fixed
  CHECK(enumerate_solutions(box).isolated == std::vector<Vector>{{0}});

  Lcp friction = lcp({1, 0, 0, 0}, {-1, 0});  // z_n = 1, any |z_t| ≤ ½
  friction.lo[1] = -kInf;
  friction.friction = {{.normal = 0, .first = 1, .mu = 0.5}};
  set = enumerate_solutions(friction);
  REQUIRE(set.faces.size() == 1);
  CHECK(set.faces[0].vertices.size() == 2);
  CHECK((has(set.faces[0].vertices, {1, -0.5}) && has(set.faces[0].vertices, {1, 0.5})));
}

TEST_CASE("all 2 x 2 and random 3 x 3, 4 x 4 matrices of -1, 0, 1: the union of points and faces is the solution set") {
  Random random(77);
  int with_faces = 0, empty = 0;
  const auto compare = [&](const Lcp& p) {
    const auto set = enumerate_solutions(p);
    with_faces += !set.faces.empty();
    empty += set.faces.empty() && set.isolated.empty();
    for (const Vector& z : grid_solutions(p)) {  // nothing is missed
      const bool there = has(set.isolated, z) || std::any_of(set.faces.begin(), set.faces.end(),
                                                             [&](const SolutionFace& f) { return member(f, z); });
      INFO("z = ", z.transpose());
      REQUIRE(there);
    }
    for (const Vector& z : set.isolated) REQUIRE(independent_residual(p, z) < 1e-15);
    for (const SolutionFace& face : set.faces) {  // nothing is too much
      REQUIRE(face.dimension >= 1);
      for (const Vector& v : face.vertices) REQUIRE(independent_residual(p, v) < 1e-15);
      for (int k = 0; k < 3; ++k) REQUIRE(independent_residual(p, inside(face, random)) < 1e-14);
      for (const Vector& z : set.isolated) REQUIRE_FALSE(member(face, z));
    }
  };
  for (int code = 0; code < 729; ++code) {
    int rest = code;
    std::vector<double> digits(6);
    for (double& d : digits) d = rest % 3 - 1, rest /= 3;
    compare(lcp({digits[0], digits[1], digits[2], digits[3]}, {digits[4], digits[5]}));
  }
  for (int trial = 0; trial < 400; ++trial) {
    const Index n = 3 + trial % 2;
    Eigen::MatrixXd M(n, n);
    Vector q(Eigen::VectorXd::Zero(n));
    for (double& entry : M.reshaped()) entry = random.integer(-1, 1);
    for (double& entry : q) entry = random.integer(-1, 1);
    compare(Lcp::standard(DenseMatrix(M), q));
  }
  CHECK(with_faces > 200);
  CHECK(empty > 50);
}

TEST_CASE("P-matrices have one solution, and twenty rows take seconds") {
  Random random(400);
  for (int k = 0; k < 200; ++k) {
    const auto set = enumerate_solutions(random_spd_problem(random.integer(1, 6), random));
    CHECK(set.isolated.size() == 1);
    CHECK(set.faces.empty());
  }
  const auto large = enumerate_solutions(random_spd_problem(20, random));
  CHECK(large.isolated.size() == 1);
  CHECK(large.faces.empty());
}

TEST_CASE("twenty rows without a helpful structure: every solution found is one") {
  Random random(401);
  Eigen::MatrixXd M(20, 20);
  for (double& entry : M.reshaped()) entry = random.normal();
  Vector q(Eigen::VectorXd::Zero(20));
  for (double& entry : q) entry = random.uniform(0.5, 1.5);
  const Lcp p = Lcp::standard(DenseMatrix(M), q);
  const auto set = enumerate_solutions(p);
  CHECK(has(set.isolated, Vector(Eigen::VectorXd::Zero(20))));
  for (const Vector& z : set.isolated) CHECK(independent_residual(p, z) < 1e-14);
  MESSAGE(set.isolated.size(), " solutions");
}

TEST_CASE("twenty degenerate rows: the largest set, zeros everywhere, a game with ties") {
  const Index n = 20;
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);
  const Vector zero(Eigen::VectorXd::Zero(n));
  CHECK(enumerate_solutions(Lcp::standard(DenseMatrix(I), zero)).isolated == std::vector<Vector>{zero});
  const auto everything = enumerate_solutions(Lcp::standard(DenseMatrix(0 * I), zero));
  REQUIRE(everything.faces.size() == 1);
  CHECK(everything.faces[0].dimension == n);
  CHECK(everything.faces[0].directions.size() == 20);
  Random random(402);
  Eigen::MatrixXd game = Eigen::MatrixXd::Zero(n, n);
  for (Index i = 0; i < n / 2; ++i)
    for (Index j = n / 2; j < n; ++j) game(i, j) = random.integer(1, 9), game(j, i) = random.integer(1, 9);
  const Lcp p = Lcp::standard(DenseMatrix(game), Vector(-Eigen::VectorXd::Ones(n)));
  const auto set = enumerate_solutions(p);
  CHECK(set.isolated.size() + set.faces.size() >= 1);
  for (const Vector& z : set.isolated) CHECK(independent_residual(p, z) < 1e-14);
}

TEST_CASE("problems that are too large or not finite are refused with a reason") {
  CHECK_THROWS_WITH_AS(enumerate_solutions(Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(21, 21)),
                                                         Vector(Eigen::VectorXd::Ones(21)))),
                       doctest::Contains("2^20"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(enumerate_solutions(lcp({std::nan("")}, {1})), doctest::Contains("finite"),
                       std::invalid_argument);
}
