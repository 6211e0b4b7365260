#include "experiments/studies/distributed/grids.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant {
namespace {

struct GridRow {
  std::array<std::pair<Index, double>, 7> entries;
  std::size_t count = 0;
  double b = 0, lo = 0, hi = kInf;
  void add(Index column, double value) { entries[count++] = {column, value}; }
};

double upper_ball(double r) { return r <= 1 ? std::sqrt(1 - r * r) : -1; }

/// −Δu above a ball in `dimension` dimensions, z = u − ψ; `u` is the exact answer, at the boundary.
template <class Exact> void ball_row(Index side, int dimension, Index row, const Exact& u, GridRow& out) {
  const double h = 4 / static_cast<double>(side + 1), per_h2 = 1 / (h * h);
  const std::array<Index, 3> node{row % side, row / side % side, row / side / side};
  const auto radius = [&](std::array<Index, 3> at) {
    const auto x = [&](std::size_t d) { return -2 + h * static_cast<double>(at[d] + 1); };
    return dimension == 2 ? std::hypot(x(0), x(1)) : std::sqrt(x(0) * x(0) + x(1) * x(1) + x(2) * x(2));
  };
  const std::array<Index, 3> stride{1, side, side * side};
  out.b = 2 * dimension * per_h2 * upper_ball(radius(node));
  const auto neighbour = [&](int d, Index by) {
    auto there = node;
    auto& place = there[static_cast<std::size_t>(d)];
    place += by;
    const bool inner = place >= 0 && place < side;
    if (inner) out.add(row + by * stride[static_cast<std::size_t>(d)], -per_h2);
    out.b -= per_h2 * (inner ? upper_ball(radius(there)) : u(radius(there)));
  };
  for (int d = dimension - 1; d >= 0; --d) neighbour(d, -1);
  out.add(row, 2 * dimension * per_h2);
  for (int d = 0; d < dimension; ++d) neighbour(d, 1);
}

void plane_ball_row(Index side, Index row, GridRow& out) {
  constexpr double rim = 0.69796514822337356642;
  ball_row(
      side, 2, row,
      [](double r) { return r <= rim ? upper_ball(r) : -rim * rim * std::log(r / 2) / std::sqrt(1 - rim * rim); }, out);
}

void space_ball_row(Index side, Index row, GridRow& out) {
  double rim = 0.8;
  for (int k = 0; k < 20; ++k) rim -= (0.5 * rim * rim * rim - 2 * rim * rim + 1) / (1.5 * rim * rim - 4 * rim);
  const double alpha = rim * rim * rim / std::sqrt(1 - rim * rim);
  ball_row(
      side, 3, row, [&](double r) { return r <= rim ? upper_ball(r) : alpha * (1 / r - 0.5); }, out);
}

void journal_row(Index side, Index row, GridRow& out) {
  constexpr double eccentricity = 0.1, half_width = 10;
  const auto n = static_cast<double>(side + 1);
  const double hx = 2 * std::numbers::pi / n, hy = 2 * half_width / n;
  const auto cubed = [&](Index i) { return std::pow(1 + eccentricity * std::cos(hx * static_cast<double>(i + 1)), 3); };
  const auto lower = [&](Index i) { return (2 * cubed(i) + cubed(i + 1)) / 6; };
  const auto upper = [&](Index i) { return (cubed(i) + 2 * cubed(i + 1)) / 6; };
  const auto along = [&](Index i) { return (lower(i) + upper(i)) * hy / hx; };       // from node i to i + 1
  const auto across = [&](Index i) { return (lower(i) + upper(i - 1)) * hx / hy; };  // from row j to j + 1
  const Index i = row % side, j = row / side;
  if (j > 0) out.add(row - side, -across(i));
  if (i > 0) out.add(row - 1, -along(i - 1));
  out.add(row, along(i - 1) + along(i) + 2 * across(i));
  if (i + 1 < side) out.add(row + 1, -along(i));
  if (j + 1 < side) out.add(row + side, -across(i));
  out.b = -eccentricity * std::sin(hx * static_cast<double>(i + 1)) * hx * hy;
}

void torsion_row(Index side, Index row, GridRow& out) {
  constexpr double twist = 5;
  const double h = 1 / static_cast<double>(side + 1);
  const Index i = row % side, j = row / side;
  const double x = h * static_cast<double>(i + 1), y = h * static_cast<double>(j + 1);
  out.hi = std::min({x, 1 - x, y, 1 - y});
  out.lo = -out.hi;
  out.b = -twist * h * h;
  if (j > 0) out.add(row - side, -1);
  if (i > 0) out.add(row - 1, -1);
  out.add(row, 4);
  if (i + 1 < side) out.add(row + 1, -1);
  if (j + 1 < side) out.add(row + side, -1);
}

}  // namespace

Index rows_of_grid(Grid grid, Index side) { return grid == Grid::space ? side * side * side : side * side; }

distributed::LocalRows part_of_grid(Grid grid, Index side, Index first, Index m) {
  distributed::LocalRows part;
  part.first = first;
  part.A.rows = m, part.A.cols = rows_of_grid(grid, side);
  const Index most = m * (grid == Grid::space ? 7 : 5);
  part.A.start.reserve(at(m + 1)), part.A.column.reserve(at(most)), part.A.value.reserve(at(most));
  part.b.resize(m), part.lo.resize(m), part.hi.resize(m);
  for (Index k = 0; k < m; ++k) {
    GridRow row;
    switch (grid) {
      case Grid::ball:
        plane_ball_row(side, first + k, row);
        break;
      case Grid::journal:
        journal_row(side, first + k, row);
        break;
      case Grid::torsion:
        torsion_row(side, first + k, row);
        break;
      case Grid::space:
        space_ball_row(side, first + k, row);
        break;
    }
    for (std::size_t e = 0; e < row.count; ++e) {
      part.A.column.push_back(static_cast<int>(row.entries[e].first));
      part.A.value.push_back(row.entries[e].second);
    }
    part.A.start.push_back(static_cast<int>(part.A.column.size()));
    part.b[k] = row.b, part.lo[k] = row.lo, part.hi[k] = row.hi;
  }
  return part;
}

}  // namespace orthant
