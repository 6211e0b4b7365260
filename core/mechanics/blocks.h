// core/mechanics/blocks.h — blocks of bodies in stacked vectors; update of poses, quaternions included.
//
//   Planar    q: x, y [m], θ [rad] of each body;  v, and all that acts like it (forces, masses, accelerations): ẋ, ẏ, ω
//   Spatial   q: x [m] in the world, unit quaternion (w, x, y, z) that turns the body's frame into the world's;
//             v: ẋ in the world, ω in the body's principal axes
// Coordinates change by a velocity times a time only through move(), and their difference is taken only by between().
// In the plane: q + step and q₁ − q₀. In space: x + step, and the quaternion times that of the rotation vector of the
// step (spatial/rotation.h).
// Code that depends on the dimension is a template on one of the two tags. Names without a tag are planar.
#pragma once

#include <orthant/core/mechanics/spatial/rotation.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace orthant {

using Vector2d = Eigen::Vector2d;
using Vector3d = Eigen::Vector3d;

using BodyId = int;
inline constexpr BodyId kGround = -1;

struct Planar {
  static constexpr int kVelocities = 3, kCoordinates = 3;  // numbers of a body in v and in q
  static constexpr int kTranslations = 2, kTangents = 1;   // of v; of a contact
  using Vector = Vector2d;
};
struct Spatial {
  static constexpr int kVelocities = 6, kCoordinates = 7;
  static constexpr int kTranslations = 3, kTangents = 2;
  using Vector = Vector3d;
};
template <class Space> inline constexpr bool kPlanar = std::is_same_v<Space, Planar>;

inline constexpr int kBlock = Planar::kVelocities;  // numbers of a body in q and in v, in the plane

/// All numbers of a body in v; those of its translation; that (those) of its rotation. Of a vector that may be written
/// to, too.
template <class Space = Planar, class X> auto block(X& x, Eigen::Index body) {
  return x.template segment<Space::kVelocities>(Space::kVelocities * body);
}
template <class Space = Planar, class X> auto translation(X& x, Eigen::Index body) {
  return x.template segment<Space::kTranslations>(Space::kVelocities * body);
}
template <class Space = Planar, class X> decltype(auto) rotation(X& x, Eigen::Index body) {
  if constexpr (kPlanar<Space>)
    return x[kBlock * body + 2];
  else
    return x.template segment<3>(Space::kVelocities * body + 3);
}
/// Likewise of q: all numbers of a body; its place; in space its quaternion (w, x, y, z).
template <class Space = Planar, class X> auto coordinates(X& q, Eigen::Index body) {
  return q.template segment<Space::kCoordinates>(Space::kCoordinates * body);
}
template <class Space = Planar, class X> auto place_of(X& q, Eigen::Index body) {
  return q.template segment<Space::kTranslations>(Space::kCoordinates * body);
}
template <class X> auto quaternion(X& q, Eigen::Index body) {
  return q.template segment<4>(Spatial::kCoordinates * body + 3);
}

/// Of a place in a stacked vector v: its body, and whether it belongs to a rotation.
template <class Space = Planar> BodyId body_of_entry(Eigen::Index i) {
  return static_cast<BodyId>(i / Space::kVelocities);
}
template <class Space = Planar> bool is_rotation(Eigen::Index i) {
  return i % Space::kVelocities >= Space::kTranslations;
}

/// The larger |entry| of body i's translation; of all of its entries.
template <class X> double largest_translation(const X& x, Eigen::Index i) {
  return std::max(std::abs(x[kBlock * i]), std::abs(x[kBlock * i + 1]));
}
template <class Space = Planar, class X> double largest_entry(const X& x, Eigen::Index i) {
  if constexpr (kPlanar<Space>)
    return std::max(largest_translation(x, i), std::abs(rotation(x, i)));
  else
    return block<Space>(x, i).cwiseAbs().maxCoeff();
}
/// The largest |entry| of body i's coordinates, in space of its place alone: a quaternion has the length 1.
template <class Space = Planar> double largest_coordinate(const Eigen::VectorXd& q, Eigen::Index i) {
  if constexpr (kPlanar<Space>)
    return largest_entry(q, i);
  else
    return place_of<Space>(q, i).cwiseAbs().maxCoeff();
}
/// Likewise as a length: angles [rad] times `unit` [m].
template <class Space = Planar> double largest_coordinate(const Eigen::VectorXd& q, Eigen::Index i, double unit) {
  if constexpr (kPlanar<Space>)
    return std::max(largest_translation(q, i), unit * std::abs(rotation(q, i)));
  else
    return largest_coordinate<Space>(q, i);
}
/// The larger of translation and rotation (times `unit` [m]) of body i, velocities or accelerations: the same in every
/// frame that is turned.
template <class Space = Planar> double largest_motion(const Eigen::VectorXd& v, Eigen::Index i, double unit = 1) {
  if constexpr (kPlanar<Space>) {
    const double* const x = v.data() + kBlock * i;
    return std::max(std::sqrt(x[0] * x[0] + x[1] * x[1]), unit * std::abs(x[2]));
  } else {
    return std::max(translation<Space>(v, i).norm(), unit * rotation<Space>(v, i).norm());
  }
}
/// The largest |entry| of all bodies' coordinates, velocities or accelerations in the plane, as a length: rotations
/// times `unit` [m].
inline double largest_of_all(const Eigen::VectorXd& x, double unit) {
  if (unit == 1) return x.lpNorm<Eigen::Infinity>();
  double most = 0;
  for (Eigen::Index i = 0; i < x.size() / kBlock; ++i)
    most = std::max({most, largest_translation(x, i), unit * std::abs(rotation(x, i))});
  return most;
}
/// The largest |rotation| of all bodies.
template <class Space = Planar> double largest_rotation(const Eigen::VectorXd& x) {
  double most = 0;
  if constexpr (kPlanar<Space>)
    for (Eigen::Index i = 2; i < x.size(); i += kBlock) most = std::max(most, std::abs(x[i]));
  else
    for (Eigen::Index i = 0; i < x.size() / Space::kVelocities; ++i)
      most = std::max(most, rotation<Space>(x, i).norm());
  return most;
}

/// to = q, moved by `step`, a velocity times a time. `to` may be q.
template <class Space = Planar, class Step>
void move(const Eigen::VectorXd& q, const Eigen::MatrixBase<Step>& step, Eigen::VectorXd& to) {
  if constexpr (kPlanar<Space>) {
    to = q + step.derived();
  } else {
    to.resize(q.size());
    for (Eigen::Index i = 0; i < q.size() / Space::kCoordinates; ++i) {
      place_of<Space>(to, i) = place_of<Space>(q, i) + step.template segment<3>(Space::kVelocities * i);
      quaternion(to, i) = quaternions::turned(quaternion(q, i), step.template segment<3>(Space::kVelocities * i + 3));
    }
  }
}
/// Moves q by `step`.
template <class Space = Planar, class Step> void move(Eigen::VectorXd& q, const Eigen::MatrixBase<Step>& step) {
  if constexpr (kPlanar<Space>)
    q += step.derived();
  else
    move<Space>(q, step, q);
}
/// The step from q0 to q1.
template <class Space = Planar> auto between(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) {
  if constexpr (kPlanar<Space>) {
    return q1 - q0;
  } else {
    const Eigen::Index bodies = q0.size() / Space::kCoordinates;
    Eigen::VectorXd step(Space::kVelocities * bodies);
    for (Eigen::Index i = 0; i < bodies; ++i) {
      translation<Space>(step, i) = place_of<Space>(q1, i) - place_of<Space>(q0, i);
      rotation<Space>(step, i) = quaternions::turn_between(quaternion(q0, i), quaternion(q1, i));
    }
    return step;
  }
}

}  // namespace orthant
