// core/support/disjoint_sets.h — disjoint sets of 0 … n − 1 (union-find): the least element of a set stands for it.
// Cost: find() and join() O(log n) amortised, by path halving.
// Source: Tarjan & van Leeuwen, J. ACM 31 (1984) 245-281.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace orthant {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// Each element's set is that of `parents`, which first() has given.
  void assign(const std::vector<int>& parents) { parent_ = parents; }

  int find(int element) {
    auto i = static_cast<std::size_t>(element);
    while (parent_[i] != static_cast<int>(i))
      parent_[i] = parent_[static_cast<std::size_t>(parent_[i])], i = static_cast<std::size_t>(parent_[i]);
    return static_cast<int>(i);
  }
  void join(int a, int b) {
    const auto [low, high] = std::minmax({find(a), find(b)});
    parent_[static_cast<std::size_t>(high)] = low;
  }
  /// Of each element the first one of its set.
  const std::vector<int>& first() {
    for (int& element : parent_) element = find(element);
    return parent_;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace orthant
