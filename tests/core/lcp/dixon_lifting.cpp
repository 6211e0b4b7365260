// Dixon's lifting: integer linear systems, checked in integers.
#include "tests/support/mechanics.h"

#include <orthant/core/lcp/judge/dixon_lifting.h>

#include <doctest/doctest.h>

using namespace orthant;
using exact::Integer, exact::IntegerTable;

namespace {

IntegerTable random_table(testing::Draws& random, std::size_t n, double most) {
  IntegerTable M(n, std::vector<Integer>(n));
  for (auto& row : M)
    for (Integer& x : row) x = Integer(std::floor(random(-most, most)));
  return M;
}

}  // namespace

TEST_CASE("Dixon's lifting: M x = r holds in integers, for small and for large entries") {
  testing::Draws random(1);
  for (const double most : {9.0, 1e15})
    for (const std::size_t n : {1U, 2U, 7U, 30U}) {
      CAPTURE(most);
      CAPTURE(n);
      const IntegerTable M = random_table(random, n, most);
      const std::vector<Integer> right = random_table(random, n, most)[0];
      const auto x = exact::solve_exactly(M, right);
      REQUIRE(x.has_value());
      CHECK(x->denominator > 0);
      for (std::size_t i = 0; i < n; ++i) {
        Integer sum = 0;
        for (std::size_t j = 0; j < n; ++j) sum += M[i][j] * x->numerators[j];
        CHECK(sum == right[i] * x->denominator);
      }
    }
}

TEST_CASE("Dixon's lifting: a matrix that is singular, or only modulo the prime, gives no answer; nor does a stop") {
  const Integer prime = (Integer(1) << 31) - 1;
  CHECK(!exact::solve_exactly({{1, 2}, {2, 4}}, {1, 1}));
  CHECK(!exact::solve_exactly({{prime}}, {1}));
  CHECK(!exact::solve_exactly({{3}}, {1}, [] { return true; }));
  CHECK(exact::solve_exactly({{3}}, {1}));
}

TEST_CASE("pivots modulo a prime: as many as the rank, in the first columns that are independent") {
  const IntegerTable A{{0, 2, 4, 1}, {0, 1, 2, 0}, {0, 3, 6, 1}};
  const auto pivots = exact::find_pivots(A, 4);
  CHECK(pivots.columns == std::vector<std::size_t>{1, 3});
  CHECK(pivots.rows.size() == 2);
  CHECK(exact::find_pivots({{0, 0}}, 2).columns.empty());
}
