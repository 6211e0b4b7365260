#include <orthant/core/support/factorization_cost.h>
#include <orthant/core/support/ordering_cost.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace orthant {
namespace {

/// Rows of the widest level of breadth-first searches that reach every row.
std::size_t widest_level(int n, const int* start, const int* index) {
  std::vector<char> met(static_cast<std::size_t>(n), 0);
  std::vector<int> queue;
  queue.reserve(met.size());
  std::size_t widest = 0;
  for (int root = 0; root < n; ++root) {
    if (met[static_cast<std::size_t>(root)] != 0) continue;
    met[static_cast<std::size_t>(root)] = 1;
    queue.assign(1, root);
    for (std::size_t begin = 0, end = 1; begin < end; begin = end, end = queue.size()) {
      widest = std::max(widest, end - begin);
      for (std::size_t k = begin; k < end; ++k)
        for (int e = start[queue[k]]; e < start[queue[k] + 1]; ++e)
          if (char& seen = met[static_cast<std::size_t>(index[e])]; seen == 0) seen = 1, queue.push_back(index[e]);
    }
  }
  return widest;
}

}  // namespace

double ordering_cost(int n, const int* start, const int* index) {
  constexpr double kEntry = 60e-9, kExpander = 1.4e-6;  // [s]
  if (n == 0) return 0;
  const double rows = n, wide = std::min(1.0, 4 * static_cast<double>(widest_level(n, start, index)) / rows);
  const double size = std::sqrt(std::min(rows / 1e5, 10.0));
  return kOperationsPerSecond * start[n] * (kEntry + kExpander * wide * size);
}

}  // namespace orthant
