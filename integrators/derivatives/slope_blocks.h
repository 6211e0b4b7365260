// integrators/derivatives/slope_blocks.h — kernels of tangents: sparse and triangular matrices times blocks of columns.
//
//   Blocks are stored by rows: entry (i, j) of direction j at i · count + j. A column has the same bits in a block of
//   any number of columns, and at each width of the processor's registers.
#pragma once

#include <Eigen/Core>
#include <span>

namespace orthant {

/// An entry of a sparse matrix that is only applied: forwards y_of += value x_by, or transposed.
struct Slope {
  Eigen::Index of = 0, by = 0;
  double value = 0;
};

template <int n> inline void add_scaled_fixed(double a, const double* x, double* y) {
  Eigen::Map<Eigen::Array<double, n, 1>>{y} += a * Eigen::Map<const Eigen::Array<double, n, 1>>{x};
}
/// y += a x, of one row of a block. Few columns: the compiler knows the lengths.
inline void add_scaled(Eigen::Index count, double a, const double* x, double* y) {
  for (; count >= 8; count -= 8, x += 8, y += 8) add_scaled_fixed<8>(a, x, y);
  if ((count & 4) != 0) add_scaled_fixed<4>(a, x, y), x += 4, y += 4;
  if ((count & 2) != 0) add_scaled_fixed<2>(a, x, y), x += 2, y += 2;
  if ((count & 1) != 0) *y += a * *x;
}

/// y_of += value x_by, one after the other.
void apply_to_block(std::span<const Slope> slopes, const double* x, double* y, Eigen::Index count);

/// L U x = P b, n × count. LU: by rows, L's diagonal 1, U's inverted; row[i]: of b in row i.
void solve_block(const double* LU, const Eigen::Index* row, Eigen::Index n, const double* b, double* x,
                 Eigen::Index count);

}  // namespace orthant
