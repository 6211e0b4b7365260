// core/mechanics/pair.h — pair of shapes that a search found: one contact of a collision set.
#pragma once

#include <compare>

namespace orthant {

/// Shapes a < b of a collision set, and which of their points.
struct Pair {
  int collision = 0, a = -1, b = -1, point = 0;  // a < 0: none
  bool none() const { return a < 0; }
  auto operator<=>(const Pair&) const = default;
};

}  // namespace orthant
