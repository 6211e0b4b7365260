// core/lcp/judge/cells.h — exhaustive search as a proof: no choice of sides has a solution, checked in rationals.
//
//   A cell chooses for each row one of lower (z_i = lo_i, w_i ≥ 0), inside (w_i = 0, z_i within) and upper (z_i = hi_i,
//   w_i ≤ 0), as far as the row has these; friction rows have ∓μ z_n for bounds. Rows are decided in this order: those
//   without a choice (free or fixed), then the others, both from the last row to the first. The sides of the first rows
//   stand for all cells that begin with them, a class. Each equation of a class, in turn, expresses one entry of z by
//   the others; an entry counts from its bound (z_i − lo_i ≥ 0, else hi_i − z_i ≥ 0, z_t + μ z_n ≥ 0), so that it has a
//   sign. A class has no solution when
//     from_lower, to_upper, w   that form of a row, which must be ≥ 0 (w ≤ 0 at hi), has a negative constant and no
//                               positive coefficient of an entry with a sign, none at all of a free one;
//     equation                  the last equation is a constant ≠ 0;
//     within                    the last row's cells are part of those of a sibling: inside, where its equation leaves
//                               nothing of a distance to a bound; lower and upper, where w = 0 throughout;
//     polyhedron                all rows are decided, and the inequalities left have no common point (exact.h: cone).
//   The classes are a proof when together they are all cells. E.g. A = −1, b = −1: lower, w = −1; inside, z = −1.
#pragma once

#include <orthant/core/lcp/solution.h>

#include <functional>

namespace orthant {

/// Number of cells.
double count_cells(const Lcp& problem);
/// True when their search costs little: at most 12 rows, none of a disc, and 4096 cells.
bool has_few_cells(const Lcp& problem);

/// Rows in the order of decision.
std::vector<Index> order_of_decision(const Lcp& problem);

/// True when `cells` are all and none has a solution. stop() is polled; where it says true: false.
bool no_cell_has_a_solution(const Lcp& problem, const std::vector<Cell>& cells, const std::function<bool()>& stop = {});

}  // namespace orthant
