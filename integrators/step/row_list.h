// integrators/step/row_list.h — rows of a step's problem: copies, or references to those of the terms.
//
// A row in space has 104 bytes. In problems of many contacts the rows of closed contacts stay where they are, in the
// terms, and the list refers to them. They must outlive it unchanged, as they do until the scheme's next step.
#pragma once

#include <cstddef>
#include <vector>

namespace orthant {

template <class Row> class RowList {
 public:
  void reserve(std::size_t rows) { own_.reserve(rows); }
  /// Empties the list. refers: add() takes references from now on.
  void begin(bool refers) {
    refers_ = refers;
    own_.clear(), at_.clear(), kept_.clear();
  }
  void clear() { begin(false); }
  void add(const Row& row) {
    if (refers_)
      at_.push_back(&row);
    else
      own_.push_back(row);
  }
  /// A copy in any case. It can be read after end().
  void keep(const Row& row) {
    if (refers_) kept_.push_back(at_.size()), at_.push_back(nullptr);
    own_.push_back(row);
  }
  void end() {
    for (std::size_t k = 0; k < kept_.size(); ++k) at_[kept_[k]] = &own_[k];
  }
  /// Reference i is to this row from now on, a copy of the one before.
  void move_reference(std::size_t i, const Row& row) { at_[i] = &row; }
  bool refers() const { return refers_; }
  Row& last_kept() { return own_.back(); }

  bool empty() const { return size() == 0; }
  std::size_t size() const { return refers_ ? at_.size() : own_.size(); }
  const Row& operator[](std::size_t i) const { return refers_ ? *at_[i] : own_[i]; }

 private:
  bool refers_ = false;
  std::vector<Row> own_;
  std::vector<const Row*> at_;     // of all, where they are references
  std::vector<std::size_t> kept_;  // places in at_ of the rows in own_
};

}  // namespace orthant
