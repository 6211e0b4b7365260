// integrators/step/islands.h — islands: bodies that act on one another; components by joints, springs and contacts.
//
//   Rows of different islands do not couple (J_i B J_jᵀ = 0): the step's problem has one block per island. The blocks'
//   solutions together solve the whole. Joints and springs connect permanently, closed contacts for the step. The
//   ground connects nothing.
// Cost: O(bodies + rows) a step, by disjoint sets.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/support/disjoint_sets.h>

#include <span>

namespace orthant {

class Islands {
 public:
  template <class Space> explicit Islands(const SystemOf<Space>& system);

  /// Sorts the rows of a problem into blocks, in the order of their first rows.
  template <class Rows> void sort(const Rows& rows);

  int count() const { return static_cast<int>(start_.size()) - 1; }  // blocks of the last sort()
  /// Its rows, ascending.
  std::span<const int> rows(int block) const {
    const auto b = static_cast<std::size_t>(block);
    return {row_.data() + start_[b], row_.data() + start_[b + 1]};
  }
  /// A body of the island that this body is in; the same one for all of them.
  int root(BodyId body) { return sets_.find(body); }

 private:
  std::vector<int> fixed_;         // by joints and springs
  DisjointSets sets_;              // now
  bool whole_;                     // all bodies are connected permanently: one island, whatever closes
  std::vector<int> block_;         // of each island's root; −1: none yet
  std::vector<int> of_row_, row_;  // block of each row; rows by blocks
  std::vector<std::size_t> start_{0};
};

}  // namespace orthant
