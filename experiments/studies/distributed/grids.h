// experiments/studies/distributed/grids.h — obstacle problems on grids, one rank's rows at a time.
//
//   The problems of core/lcp/problems/obstacles.h, each row by itself: no rank holds more than its own rows. Nodes row
//   by row of the grid, x fastest.
#pragma once

#include <orthant/solvers/distributed/distributed_lcp.h>

#include <array>
#include <string_view>

namespace orthant {

enum class Grid { ball, journal, torsion, space };
inline constexpr std::array<std::string_view, 4> kGridNames{"ball", "journal", "torsion", "space"};

/// Number of rows with `side` inner nodes a side.
Index rows_of_grid(Grid grid, Index side);
/// Rows first … first + m − 1.
distributed::LocalRows part_of_grid(Grid grid, Index side, Index first, Index m);

}  // namespace orthant
