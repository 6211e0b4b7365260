// core/lcp/judge/cell_words.h — words for the classes of a search of all cells (cells.h), for files and tables.
#pragma once

#include <orthant/core/lcp/solution.h>

#include <string>
#include <string_view>

namespace orthant {

/// A letter for each decided row, in the order of decision: L lower, I inside, U upper.
std::string letters(const Cell& cell);

/// Reason why the class has no solution: "z - lower < 0", "upper - z < 0", "w", "equation", "within", "polyhedron".
std::string_view words_of(Cell::Why why);

}  // namespace orthant
