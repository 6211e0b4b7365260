// Predicted work of sparse factorizations: known patterns.
#include <orthant/core/support/factorization_cost.h>
#include <orthant/core/support/ordering_cost.h>
#include <orthant/core/support/random.h>

#include <doctest/doctest.h>

#include <cstdlib>
#include <utility>
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

TEST_CASE("the cost of an ordering: little an entry of a band or a grid, much of entries at random") {
  using Edges = std::vector<std::pair<int, int>>;
  const auto seconds = [](int n, const Edges& edges) {
    std::vector<std::vector<int>> rows(static_cast<std::size_t>(n));
    for (const auto& [i, j] : edges)
      rows[static_cast<std::size_t>(i)].push_back(j), rows[static_cast<std::size_t>(j)].push_back(i);
    std::vector<int> start{0}, index;
    for (const auto& row : rows) {
      index.insert(index.end(), row.begin(), row.end());
      start.push_back(static_cast<int>(index.size()));
    }
    return orthant::ordering_cost(n, start.data(), index.data()) / orthant::kOperationsPerSecond;
  };
  constexpr int n = 40000, side = 200;
  Edges band, grid, any;
  orthant::Random random(1);
  for (int i = 0; i < n; ++i) {
    if (i + 1 < n) band.emplace_back(i, i + 1);
    if (i % side + 1 < side) grid.emplace_back(i, i + 1);
    if (i + side < n) grid.emplace_back(i, i + side);
    for (int k = 0; k < 2; ++k) any.emplace_back(i, random.integer(0, n - 1));
  }
  CHECK(seconds(0, {}) == 0);
  CHECK(seconds(n, band) == doctest::Approx(60e-9 * 2 * n).epsilon(0.01));
  CHECK(seconds(n, grid) < 2 * 60e-9 * 4 * n);
  CHECK(seconds(n, any) > 10 * 60e-9 * 4 * n);
  Edges scattered;  // pairs, each a search of its own
  for (int i = 0; i < n; i += 2) scattered.emplace_back(i, i + 1);
  CHECK(seconds(n, scattered) == doctest::Approx(60e-9 * n).epsilon(0.01));
}
