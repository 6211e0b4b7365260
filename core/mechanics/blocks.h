// core/mechanics/blocks.h — blocks of bodies in stacked vectors, and steps between poses.
//
//   q: x, y [m], θ [rad] of each body;  v, and all that acts like it (forces, masses, accelerations): ẋ, ẏ, ω
// Coordinates change by a velocity times a time only through move(), and their difference is taken only by between():
// here q + step and q₁ − q₀.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace orthant {

using Vector2d = Eigen::Vector2d;

using BodyId = int;
inline constexpr BodyId kGround = -1;

inline constexpr int kBlock = 3;  // numbers of a body in q and in v

/// All numbers of a body; those of its translation; that of its rotation. Of a vector that may be written to, too.
template <class X> auto block(X& x, Eigen::Index body) { return x.template segment<kBlock>(kBlock * body); }
template <class X> auto translation(X& x, Eigen::Index body) { return x.template segment<2>(kBlock * body); }
template <class X> decltype(auto) rotation(X& x, Eigen::Index body) { return x[kBlock * body + 2]; }

/// Of a place in a stacked vector: its body, and whether it belongs to a rotation.
inline BodyId body_of_entry(Eigen::Index i) { return static_cast<BodyId>(i / kBlock); }
inline bool is_rotation(Eigen::Index i) { return i % kBlock == 2; }

/// The larger |entry| of body i's translation; of all of its entries.
template <class X> double largest_translation(const X& x, Eigen::Index i) {
  return std::max(std::abs(x[kBlock * i]), std::abs(x[kBlock * i + 1]));
}
template <class X> double largest_entry(const X& x, Eigen::Index i) {
  return std::max(largest_translation(x, i), std::abs(rotation(x, i)));
}
/// The larger of translation and rotation of body i, velocities or accelerations: the same in every frame that is
/// turned.
inline double largest_motion(const Eigen::VectorXd& v, Eigen::Index i) {
  const double* const x = v.data() + kBlock * i;
  return std::max(std::sqrt(x[0] * x[0] + x[1] * x[1]), std::abs(x[2]));
}
/// The largest |rotation| of all bodies.
inline double largest_rotation(const Eigen::VectorXd& x) {
  double most = 0;
  for (Eigen::Index i = 2; i < x.size(); i += kBlock) most = std::max(most, std::abs(x[i]));
  return most;
}

/// to = q, moved by `step`, a velocity times a time. `to` may be q.
template <class Step> void move(const Eigen::VectorXd& q, const Eigen::MatrixBase<Step>& step, Eigen::VectorXd& to) {
  to = q + step.derived();
}
/// Moves q by `step`.
template <class Step> void move(Eigen::VectorXd& q, const Eigen::MatrixBase<Step>& step) { q += step.derived(); }
/// The step from q0 to q1.
inline auto between(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) { return q1 - q0; }

}  // namespace orthant
