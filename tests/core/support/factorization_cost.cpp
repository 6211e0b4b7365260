// Predicted work of sparse factorizations: known patterns.
#include <orthant/core/support/factorization_cost.h>

#include <doctest/doctest.h>

#include <cstdlib>
#include <vector>

TEST_CASE("the cost of a factorization: none without entries, linear of a band, cubic of a full matrix") {
  const auto cost = [](int n, int half_width) {
    std::vector<int> start{0}, index;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i)
        if (half_width >= 0 && std::abs(i - j) <= half_width) index.push_back(i);
      start.push_back(static_cast<int>(index.size()));
    }
    return orthant::factorization_cost(n, start.data(), index.data());
  };
  CHECK(cost(0, 0) == 0);
  CHECK(cost(1, -1) == 0);
  CHECK(cost(5, -1) == 0);
  CHECK(cost(200, 1) == doctest::Approx(2 * cost(100, 1)).epsilon(0.05));
  CHECK(cost(100, 100) == doctest::Approx(2.0 / 3 * 1e6).epsilon(0.05));
}
