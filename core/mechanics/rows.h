// core/mechanics/rows.h — constraint rows: the Jacobian entries of at most two bodies, and the operations on them.
//
//   rate = ja · v_a + jb · v_b,   v: the stacked velocities of all bodies (blocks.h)
// Every joint and contact acts on two bodies at the most, so a Jacobian is a list of rows. Other files read and change
// entries through these operations. The ground has no velocities: its entries are not read.
#pragma once

#include <orthant/core/mechanics/blocks.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace orthant {

template <class Space> struct RowOf {
  using Entries = std::array<double, Space::kVelocities>;
  BodyId a = kGround, b = kGround;
  Entries ja{}, jb{};
};
using Row = RowOf<Planar>;

/// Poses and twists of all bodies; defined by planar/geometry.h and spatial/geometry.h.
template <class Space> struct KinematicsOf;

namespace detail {

/// Σ j_k v_k, the first one first.
template <std::size_t n> inline double sum_of_products(const std::array<double, n>& j, const double* v) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) { return (... + (j[k] * v[k])); }
  (std::make_index_sequence<n>{});
}

}  // namespace detail

/// J v of one row.
template <class Space> inline double apply(const RowOf<Space>& row, const double* v) {
  double sum = 0;
  if (row.a >= 0) sum += detail::sum_of_products(row.ja, v + Space::kVelocities * row.a);
  if (row.b >= 0) sum += detail::sum_of_products(row.jb, v + Space::kVelocities * row.b);
  return sum;
}

/// f += Jᵀ λ of one row.
template <class Space> inline void apply_transposed(const RowOf<Space>& row, double lambda, double* f) {
  constexpr int n = Space::kVelocities;
  if (row.a >= 0)
    for (int k = 0; k < n; ++k) f[n * row.a + k] += row.ja[static_cast<std::size_t>(k)] * lambda;
  if (row.b >= 0)
    for (int k = 0; k < n; ++k) f[n * row.b + k] += row.jb[static_cast<std::size_t>(k)] * lambda;
}

/// v += M⁻¹ Jᵀ λ of one row. inverse_mass: the diagonal of M⁻¹.
template <class Space> inline void apply_impulse(const RowOf<Space>& row, double lambda,
                                                 const Eigen::VectorXd& inverse_mass, Eigen::VectorXd& v) {
  constexpr int n = Space::kVelocities;
  const auto push = [&](BodyId body, const typename RowOf<Space>::Entries& j) {
    for (int k = 0; body >= 0 && k < n; ++k)
      v[n * body + k] += inverse_mass[n * body + k] * j[static_cast<std::size_t>(k)] * lambda;
  };
  push(row.a, row.ja), push(row.b, row.jb);
}

/// J_i M⁻¹ J_jᵀ of two rows; of a row with itself: the inverse of its effective mass without joints.
template <class Space>
inline double coupling(const RowOf<Space>& i, const RowOf<Space>& j, const Eigen::VectorXd& inverse_mass) {
  using Entries = typename RowOf<Space>::Entries;
  constexpr int n = Space::kVelocities;
  double sum = 0;
  const auto add = [&](BodyId body, const Entries& u, BodyId other, const Entries& v) {
    if (body < 0 || body != other) return;
    for (std::size_t k = 0; k < n; ++k) sum += u[k] * inverse_mass[n * body + static_cast<Eigen::Index>(k)] * v[k];
  };
  add(i.a, i.ja, j.a, j.ja), add(i.a, i.ja, j.b, j.jb), add(i.b, i.jb, j.a, j.ja), add(i.b, i.jb, j.b, j.jb);
  return sum;
}

/// `by` times the row.
template <class Space> inline RowOf<Space> scaled(RowOf<Space> row, double by) {
  for (std::size_t k = 0; k < Space::kVelocities; ++k) row.ja[k] *= by, row.jb[k] *= by;
  return row;
}

/// Whether both rows act on the same bodies, in the same order.
template <class Space> inline bool same_bodies(const RowOf<Space>& row, const RowOf<Space>& other) {
  return row.a == other.a && row.b == other.b;
}

/// row + factor · other, of rows that act on the same bodies.
template <class Space> inline RowOf<Space> combined(RowOf<Space> row, double factor, const RowOf<Space>& other) {
  for (std::size_t k = 0; k < Space::kVelocities; ++k)
    row.ja[k] += factor * other.ja[k], row.jb[k] += factor * other.jb[k];
  return row;
}

/// sum += factor · row. `sum` has the bodies that `row` acts on, in either order.
template <class Space> inline void add_to(RowOf<Space>& sum, double factor, const RowOf<Space>& row) {
  const auto put = [&](BodyId body, const typename RowOf<Space>::Entries& j) {
    if (body < 0) return;
    auto& to = body == sum.a ? sum.ja : sum.jb;
    for (std::size_t k = 0; k < Space::kVelocities; ++k) to[k] += factor * j[k];
  };
  put(row.a, row.ja), put(row.b, row.jb);
}

/// Whether all entries are zero.
template <class Space> inline bool zero(const RowOf<Space>& row) {
  constexpr typename RowOf<Space>::Entries none{};
  return row.ja == none && row.jb == none;
}

/// The same bodies, all entries zero.
template <class Space> inline RowOf<Space> blank(const RowOf<Space>& row) { return {row.a, row.b, {}, {}}; }

/// Calls f(place in v, entry) over the entries of the row, those of its two bodies by turns.
template <class Space, class F> void each_entry(const RowOf<Space>& row, F&& f) {
  constexpr int n = Space::kVelocities;
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (row.a >= 0) f(n * row.a + i, row.ja[k]);
    if (row.b >= 0) f(n * row.b + i, row.jb[k]);
  }
}

/// Appends the entries to a sparse matrix row by row; places ascend.
template <class Space>
inline void append_to(std::vector<int>& place, std::vector<double>& value, const RowOf<Space>& row) {
  constexpr int n = Space::kVelocities;
  const auto push = [&](BodyId body, const typename RowOf<Space>::Entries& j) {
    for (int k = 0; body >= 0 && k < n; ++k)
      place.push_back(n * body + k), value.push_back(j[static_cast<std::size_t>(k)]);
  };
  if (row.a < row.b)
    push(row.a, row.ja), push(row.b, row.jb);
  else
    push(row.b, row.jb), push(row.a, row.ja);
}

/// The direction in which an impulse of the row pushes the centre of `body`, one of its two.
template <class Space> inline typename Space::Vector push_on(const RowOf<Space>& row, BodyId body) {
  const auto& j = row.a == body ? row.ja : row.jb;
  if constexpr (kPlanar<Space>)
    return {j[0], j[1]};
  else
    return {j[0], j[1], j[2]};
}

/// A bound of |J x|: translations of a body are at most translation(body) in each direction, rotations are those of x.
template <class Translation> double reach(const Row& row, const Eigen::VectorXd& x, Translation&& translation) {
  double sum = 0;
  const auto add = [&](BodyId body, const Row::Entries& j) {
    if (body >= 0) sum += (std::abs(j[0]) + std::abs(j[1])) * translation(body) + std::abs(j[2] * rotation(x, body));
  };
  add(row.a, row.ja), add(row.b, row.jb);
  return sum;
}

}  // namespace orthant
