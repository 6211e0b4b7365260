// core/support/ordering_cost.h — time of a fill-reducing ordering, predicted from the pattern before it begins.
//
//   Minimum degree cannot be interrupted. It takes 25 to 150 ns an entry on bands and grids, but 0.5 to 1.5 µs where
//   the graph of the matrix is an expander, as with entries at random. There breadth-first levels hold a large part of
//   the rows: L of n in the widest one, n^(1/2) on a plane grid, n^(2/3) in space. Predicted, an entry:
//     60 ns + 1.4 µs min(1, 4 L / n) √(n / 1e5), the root at most that of n / 1e5 = 10.
//   Measured on 1e4 to 1e5 rows; too much by up to ten times for stars, which have wide levels and no fill.
//   Cost: one pass over the entries, some 10 ns each.
#pragma once

namespace orthant {

/// Of AMD, of n × n compressed columns (or rows), in the operations of kOperationsPerSecond.
double ordering_cost(int n, const int* start, const int* index);

}  // namespace orthant
