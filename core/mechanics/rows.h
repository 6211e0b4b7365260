// core/mechanics/rows.h — constraint rows: the Jacobian entries of two bodies at the most, and the verbs on them.
//
//   rate = ja · v_a + jb · v_b,   v: the stacked velocities of all bodies (blocks.h)
// Every joint and contact acts on two bodies at the most, so a Jacobian is a list of rows. Other files read and change
// entries through these verbs. The ground has no velocities: its entries are not read.
#pragma once

#include <orthant/core/mechanics/blocks.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace orthant {

struct Row {
  using Entries = std::array<double, kBlock>;
  BodyId a = kGround, b = kGround;
  Entries ja{}, jb{};
};

/// J v of one row.
inline double apply(const Row& row, const double* v) {
  double sum = 0;
  if (row.a >= 0) {
    const double* va = v + kBlock * row.a;
    sum += row.ja[0] * va[0] + row.ja[1] * va[1] + row.ja[2] * va[2];
  }
  if (row.b >= 0) {
    const double* vb = v + kBlock * row.b;
    sum += row.jb[0] * vb[0] + row.jb[1] * vb[1] + row.jb[2] * vb[2];
  }
  return sum;
}

/// f += Jᵀ λ of one row.
inline void apply_transposed(const Row& row, double lambda, double* f) {
  if (row.a >= 0)
    for (int k = 0; k < kBlock; ++k) f[kBlock * row.a + k] += row.ja[static_cast<std::size_t>(k)] * lambda;
  if (row.b >= 0)
    for (int k = 0; k < kBlock; ++k) f[kBlock * row.b + k] += row.jb[static_cast<std::size_t>(k)] * lambda;
}

/// v += M⁻¹ Jᵀ λ of one row. inverse_mass: the diagonal of M⁻¹.
inline void apply_impulse(const Row& row, double lambda, const Eigen::VectorXd& inverse_mass, Eigen::VectorXd& v) {
  const auto push = [&](BodyId body, const Row::Entries& j) {
    for (int k = 0; body >= 0 && k < kBlock; ++k)
      v[kBlock * body + k] += inverse_mass[kBlock * body + k] * j[static_cast<std::size_t>(k)] * lambda;
  };
  push(row.a, row.ja), push(row.b, row.jb);
}

/// J_i M⁻¹ J_jᵀ of two rows; of a row with itself: the inverse of its effective mass without joints.
inline double coupling(const Row& i, const Row& j, const Eigen::VectorXd& inverse_mass) {
  double sum = 0;
  const auto add = [&](BodyId body, const Row::Entries& u, BodyId other, const Row::Entries& v) {
    if (body < 0 || body != other) return;
    for (std::size_t k = 0; k < kBlock; ++k)
      sum += u[k] * inverse_mass[kBlock * body + static_cast<Eigen::Index>(k)] * v[k];
  };
  add(i.a, i.ja, j.a, j.ja), add(i.a, i.ja, j.b, j.jb), add(i.b, i.jb, j.a, j.ja), add(i.b, i.jb, j.b, j.jb);
  return sum;
}

/// `by` times the row.
inline Row scaled(Row row, double by) {
  for (std::size_t k = 0; k < kBlock; ++k) row.ja[k] *= by, row.jb[k] *= by;
  return row;
}

/// Whether both rows act on the same bodies, in the same order.
inline bool same_bodies(const Row& row, const Row& other) { return row.a == other.a && row.b == other.b; }

/// row + factor · other, of rows that act on the same bodies.
inline Row combined(Row row, double factor, const Row& other) {
  for (std::size_t k = 0; k < kBlock; ++k) row.ja[k] += factor * other.ja[k], row.jb[k] += factor * other.jb[k];
  return row;
}

/// sum += factor · row. `sum` has the bodies that `row` acts on, in either order.
inline void add_to(Row& sum, double factor, const Row& row) {
  const auto put = [&](BodyId body, const Row::Entries& j) {
    if (body < 0) return;
    Row::Entries& to = body == sum.a ? sum.ja : sum.jb;
    for (std::size_t k = 0; k < kBlock; ++k) to[k] += factor * j[k];
  };
  put(row.a, row.ja), put(row.b, row.jb);
}

/// Whether all entries are zero.
inline bool zero(const Row& row) {
  constexpr Row::Entries none{};
  return row.ja == none && row.jb == none;
}

/// The same bodies, all entries zero.
inline Row blank(const Row& row) { return {row.a, row.b, {}, {}}; }

/// Calls f(place in v, entry) over the entries of the row, those of its two bodies by turns.
template <class F> void each_entry(const Row& row, F&& f) {
  for (std::size_t k = 0; k < kBlock; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (row.a >= 0) f(kBlock * row.a + i, row.ja[k]);
    if (row.b >= 0) f(kBlock * row.b + i, row.jb[k]);
  }
}

/// Appends the entries to a sparse matrix row by row; places ascend.
inline void append_to(std::vector<int>& place, std::vector<double>& value, const Row& row) {
  const auto push = [&](BodyId body, const Row::Entries& j) {
    for (int k = 0; body >= 0 && k < kBlock; ++k)
      place.push_back(kBlock * body + k), value.push_back(j[static_cast<std::size_t>(k)]);
  };
  if (row.a < row.b)
    push(row.a, row.ja), push(row.b, row.jb);
  else
    push(row.b, row.jb), push(row.a, row.ja);
}

/// The direction in which an impulse of the row pushes the centre of `body`, one of its two.
inline Vector2d push_on(const Row& row, BodyId body) {
  const Row::Entries& j = row.a == body ? row.ja : row.jb;
  return {j[0], j[1]};
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
