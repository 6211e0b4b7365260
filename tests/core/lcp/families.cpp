#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/american_put.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/families.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "tests/support/judge.h"

using namespace orthant;

namespace {

bool same(const Lcp& a, const Lcp& b) {
  DenseMatrix A, B;
  to_dense(a.A, A);
  to_dense(b.A, B);
  return A == B && a.b == b.b && a.lo == b.lo && a.hi == b.hi && a.friction.size() == b.friction.size();
}

}  // namespace

TEST_CASE("families: well formed, the same from the same seed, and what is said of their answers holds") {
  std::set<std::string_view> names;
  for (const Family& family : families()) {
    INFO(family.name);
    CHECK(names.insert(family.name).second);
    CHECK(find_family(family.name) == &family);
    REQUIRE(!family.sizes.empty());
    REQUIRE(!family.hardness.empty());
    for (const double hardness : family.hardness) {
      const Known k = family.make(family.sizes[0], hardness, 1);
      INFO("hardness ", hardness, ", n = ", k.problem.size());
      check(k.problem);
      CHECK(k.answer == family.answer);
      CHECK(k.problem.size() <= 2 * family.sizes[0]);
      CHECK(k.problem.size() >= family.sizes[0] / 2);
      CHECK(same(k.problem, family.make(family.sizes[0], hardness, 1).problem));
      if (k.z.size() > 0) CHECK(independent_residual(k.problem, k.z) < 1e-15);
      Solution s;
      make_solver("lemke")->solve(k.problem, s);
      CHECK((k.answer == Answer::infeasible ? s.status == Status::infeasible : has_answer(s.status)));
    }
  }
  CHECK(find_family("no such family") == nullptr);
}

TEST_CASE("beam on an obstacle: sinks by the load's exact bending, or rests in the middle") {
  const auto solver = make_solver("interior-point");
  Solution s;
  REQUIRE(solver->solve(beam_on_obstacle(32, 2), s).status == Status::solved);
  CHECK(s.z[31] < 1.001);  // cubic elements: exact at the nodes under a uniform load
  for (Index i = 1; i < 32; ++i) {
    const double x = static_cast<double>(i) / 32;
    CHECK(s.z[2 * i - 1] == doctest::Approx(2 - 3.2 * (x - 2 * x * x * x + x * x * x * x)).epsilon(1e-9));
  }
  REQUIRE(solver->solve(beam_on_obstacle(32), s).status == Status::solved);
  CHECK(s.z[31] == 0);
  CHECK(s.w[31] == doctest::Approx(384.0 / 5 * 5 / 8 * (1 - 0.5)).epsilon(1e-9));  // of the middle support's 5/8
}

TEST_CASE("contact piles: rows a contact, redundancy, forces that carry the weight") {
  Solution s;
  const auto solver = make_solver("lemke");
  for (const bool spatial : {false, true})
    for (const double mu : {0.0, 0.5}) {
      const Lcp p = box_column(3, {.mu = mu, .spatial = spatial});
      const Index rows = mu == 0 ? 1 : spatial ? 3 : 2;
      CHECK(p.size() == 3 * (spatial ? 4 : 2) * rows);
      REQUIRE(solver->solve(p, s).status == Status::solved);
      double ground = 0;
      for (Index i = 0; i < (spatial ? 4 : 2); ++i) ground += s.z[i * rows];
      CHECK(ground == doctest::Approx(3 * 9.81e-3).epsilon(1e-12));  // three boxes of 1 kg, a step of 1 ms
    }
  // On a slope boxes slide when tan(slope) > mu, and only then.
  for (const double slope : {0.2, 0.3}) {
    const Lcp p = box_column(1, {.mu = 0.25, .slope = slope});
    REQUIRE(solver->solve(p, s).status == Status::solved);
    CHECK((s.w[1] > 1e-6) == (std::tan(slope) > 0.25));
  }
  CHECK_THROWS_WITH(box_column(0, {}), "boxes = 0: must be ≥ 1");
  CHECK_THROWS(box_column(2, {.mu = -1}));
  CHECK_THROWS(brick_wall(2, {.spatial = true}));
}

TEST_CASE("American put: the value of the literature, second order with implicit steps at the start") {
  const auto solver = make_solver("block-pivot");
  const auto price = [&](AmericanPut put, double S, Index steps) {
    Vector V = put.payoff();
    const Vector psi = V;
    const double h = put.maturity / static_cast<double>(steps);
    Solution s;
    const auto step = [&](double length, double theta) {
      REQUIRE(solver->solve(american_put_step(put, V, length, theta), s).status == Status::solved);
      V = s.z + psi;
    };
    for (int k = 0; k < 4; ++k) step(h / 4, 1);
    for (Index k = 1; k < steps; ++k) step(h, 0.5);
    return put.value(V, S);
  };
  // Binomial trees with 10^5 steps and more, both parameter sets.
  constexpr double exact = 6.0903706;
  double errors[3];
  for (int k = 0; k < 3; ++k) {
    const Index n = 100 << k;
    errors[k] = std::abs(price({.nodes = n - 1}, 100, n) - exact);
  }
  CHECK(errors[1] < 1e-2);
  CHECK(std::log2(errors[0] / errors[2]) / 2 > 1.5);
  CHECK(std::abs(price({.strike = 40, .rate = 0.06, .largest = 120, .nodes = 399}, 36, 400) - 4.4866744) < 2e-3);
}

TEST_CASE("obstacle in space: second order towards the exact answer, which meets the ball smoothly") {
  const auto solver = make_solver("multigrid");
  double errors[2];
  for (int k = 0; k < 2; ++k) {
    const SpaceObstacle ball = space_obstacle(16 << k);
    Solution s;
    REQUIRE(solver->solve(ball.problem, s).status == Status::solved);
    errors[k] = (s.z - ball.exact).lpNorm<Eigen::Infinity>();
    const double r = ball.rim;
    CHECK(std::sqrt(1 - r * r) == doctest::Approx(r * r * r / std::sqrt(1 - r * r) * (1 / r - 0.5)).epsilon(1e-12));
  }
  CHECK(errors[0] / errors[1] > 2);
  CHECK(errors[1] < 0.02);
}

TEST_CASE("elastic-plastic torsion: elastic under a small twist, plastic near the edges under a large one") {
  const auto solver = make_solver("multigrid");
  Solution s;
  const double h = 1.0 / 64;
  REQUIRE(solver->solve(elastic_plastic_torsion(63, 63, 1), s).status == Status::solved);
  CHECK(std::abs(h * h * s.z.sum() - 0.0351443) < 1e-4);  // of −Δu = 1 on the unit square: the torsion constant / 4
  const Lcp p = elastic_plastic_torsion(63, 63, 50);
  REQUIRE(solver->solve(p, s).status == Status::solved);
  CHECK(h * h * s.z.sum() < 1.0 / 6);  // volume of the pyramid of slope 1
  CHECK(h * h * s.z.sum() > 0.9 / 6);
  CHECK(s.z[31] == p.hi[31]);  // at the middle of an edge
  CHECK(s.z[31 * 63 + 31] < p.hi[31 * 63 + 31]);
}

TEST_CASE("American option on two assets: of one asset, and of two that move together, the value of one") {
  const auto solver = make_solver("auto");
  const auto price = [&](const AmericanBasket& basket) {
    Vector V = basket.payoff();
    const Vector psi = V;
    Solution s;
    for (int k = 0; k < 40; ++k) {
      REQUIRE(solver->solve(american_basket_step(basket, V, basket.maturity / 40), s).status == Status::solved);
      V = s.z + psi;
    }
    return basket.at_spot(V);
  };
  constexpr double one = 6.0903706;  // as above
  CHECK(std::abs(price({.weight = 1, .nodes = 41}) - one) < 0.1);
  CHECK(std::abs(price({.correlation = 1, .nodes = 41}) - one) < 0.1);
  CHECK(price({.correlation = -0.5, .nodes = 41}) < 0.6 * one);  // losses of one are made up for by the other
}
