// integrators/derivatives/row_slope.h — row slopes: how the entries of a row change with the poses of its two bodies.
//
//   ∂j_of / ∂q_by of the places `of` and `by` in stacked vectors; those that are 0 are left out
// Rows of pins, slides, corners and discs on walls are affine in the places and, of each angle, in its sine and cosine:
//   ∂f/∂θ = (f(θ + π/2) − f(θ − π/2)) / 2,   ∂f/∂x = (f(x + 1) − f(x − 1)) / 2
// hold exactly. Spans, distances, journals and pairs of discs have formulas. Polygons and custom elements take central
// differences of fourth order over 3e-6 m (rad): a relative error of about 1e-9 at a radius of 1 mm.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/integrators/derivatives/slope_blocks.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>

namespace orthant {

template <class Space> struct RowSlopeOf {
  std::array<Slope, 4 * Space::kVelocities * Space::kVelocities> entries;
  std::size_t count = 0;
  const Slope* begin() const { return entries.data(); }
  const Slope* end() const { return entries.data() + count; }
  void add(Eigen::Index of, Eigen::Index by, double value) {
    if (value != 0) entries[count++] = {of, by, value};
  }
};
using RowSlope = RowSlopeOf<Planar>;

/// Of all rows of a joint; of normal and tangent of a contact; of one row. `at` is moved and put back.
void slopes_of(const Joint& joint, Kinematics& at, RowSlope* slopes);
void slopes_of(const Contact& contact, Kinematics& at, std::array<RowSlope, 2>& slopes);
void slope_of(const Coordinate& coordinate, Kinematics& at, RowSlope& slope);
void slope_of(const Spring& spring, Kinematics& at, RowSlope& slope);

inline void apply(const std::vector<Slope>& slopes, const double* x, double* y) {
  for (const Slope& s : slopes) y[s.of] += s.value * x[s.by];
}
/// Likewise of blocks of `count` columns, stored by rows: row i begins at i · count.
inline void apply(const std::vector<Slope>& slopes, const double* x, double* y, Eigen::Index count) {
  count == 1 ? apply(slopes, x, y) : apply_to_block(slopes, x, y, count);
}
/// to += by · J x and f += Jᵀ (by · λ) of one row, of such blocks.
template <class Space>
inline void add_rate(const RowOf<Space>& row, double by, const double* x, Eigen::Index count, double* to) {
  each_entry(row, [&](Eigen::Index place, double j) { add_scaled(count, by * j, x + place * count, to); });
}
template <class Space>
inline void add_impulse(const RowOf<Space>& row, double by, const double* lambda, Eigen::Index count, double* f) {
  each_entry(row, [&](Eigen::Index place, double j) { add_scaled(count, by * j, lambda, f + place * count); });
}
inline void apply_transposed(const std::vector<Slope>& slopes, const double* y, double* x) {
  for (const Slope& s : slopes) x[s.by] += s.value * y[s.of];
}

/// (ja, jb).
template <class Space> inline std::array<double, 2 * Space::kVelocities> entries_of(const RowOf<Space>& row) {
  std::array<double, 2 * Space::kVelocities> both;
  std::copy(row.ja.begin(), row.ja.end(), both.begin());
  std::copy(row.jb.begin(), row.jb.end(), both.begin() + Space::kVelocities);
  return both;
}
/// Where entry k of them stands in stacked vectors; −1: it is the ground's.
template <class Space> inline Eigen::Index place_of_entry(const RowOf<Space>& row, std::size_t k) {
  constexpr std::size_t n = Space::kVelocities;
  const BodyId body = k < n ? row.a : row.b;
  return body < 0 ? -1 : static_cast<Eigen::Index>(n) * body + static_cast<Eigen::Index>(k % n);
}

}  // namespace orthant
