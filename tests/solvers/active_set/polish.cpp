#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/active_set/polish.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "tests/support/judge.h"

using namespace orthant;

namespace {

/// z as an interior-point method leaves it: off by about `size`, in units of each row.
Vector blurred(const Vector& z, double size, Random& random) {
  Vector result = z;
  for (double& value : result)
    value += (std::abs(value) + 1e-3 * z.lpNorm<Eigen::Infinity>()) * random.uniform(0, size);
  return result;
}

double residual_of(const Lcp& problem, const Vector& z) {
  Solution s;
  s.z = z;
  Judge().certify(problem, 0, Claim::stalled, s);
  return s.residual;
}

}  // namespace

TEST_CASE("a blurred solution is polished to rounding: the whole collection, dense and sparse") {
  Random random(5);
  for (const Known& k : known_problems()) {
    if (k.z.size() == 0 || !k.problem.friction.empty()) continue;
    for (const Lcp& p : {k.problem, as_sparse(k.problem)}) {
      INFO(k.name);
      Vector z = blurred(k.z, 1e-7, random);
      Polish polish;
      CHECK(polish.improve(p, z, {}));
      CHECK(independent_residual(p, z) < 1e-14);
    }
  }
}

TEST_CASE("degenerate and rank-deficient monotone problems are polished, a singular block or not") {
  Random random(6);
  Polish polish;
  int exact = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const int n = random.integer(1, 40);
    const Known k = planted_problem(n, random.integer(0, n), random.integer(0, n), random);
    for (const Lcp& p : {k.problem, as_sparse(k.problem)}) {
      Vector z = blurred(k.z, 1e-6, random);
      polish.improve(p, z, {});
      exact += independent_residual(p, z) < 1e-14;
    }
  }
  CHECK(exact >= 980);  // of 1000
}

TEST_CASE("polishing never makes z worse, keeps it in the bounds, and leaves what is not finite alone") {
  Random random(7);
  Polish polish;
  for (int trial = 0; trial < 300; ++trial) {
    const Lcp p = random_integer_problem(random.integer(1, 6), {.free = true, .box = true}, random);
    Vector z(Eigen::VectorXd::Zero(p.size()));
    for (double& value : z) value = random.normal();
    z = z.cwiseMax(p.lo).cwiseMin(p.hi);
    const double before = residual_of(p, z);
    const bool exact = polish.improve(p, z, {});
    CHECK((z.array() >= p.lo.array() && z.array() <= p.hi.array()).all());
    CHECK(residual_of(p, z) <= (exact ? 1e-14 : before));
  }
  const Lcp p = random_spd_problem(3, random);
  Vector z{1, std::numeric_limits<double>::quiet_NaN(), 0};
  CHECK_FALSE(polish.improve(p, z, {}));
  CHECK(z[0] == 1);
}
