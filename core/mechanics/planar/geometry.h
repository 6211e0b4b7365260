// core/mechanics/planar/geometry.h — planar poses and twists, and the row of a direction at two points.
#pragma once

#include <orthant/core/mechanics/rows.h>

#include <limits>
#include <vector>

namespace orthant {

/// Left-hand normal: ω × r = ω perp(r).
inline Vector2d perp(const Vector2d& r) { return {-r.y(), r.x()}; }
/// z-component of r × f.
inline double cross(const Vector2d& r, const Vector2d& f) { return r.x() * f.y() - r.y() * f.x(); }

/// Position of a body's centre and its orientation as (cos θ, sin θ); the ground's is the identity.
struct Pose {
  Vector2d x{0, 0};
  double theta = 0, c = 1, s = 0;
  Vector2d turn(const Vector2d& p) const { return {c * p.x() - s * p.y(), s * p.x() + c * p.y()}; }
  Vector2d turn_back(const Vector2d& p) const { return {c * p.x() + s * p.y(), c * p.y() - s * p.x()}; }
};

/// Velocity of a body's centre and its angular velocity.
struct Twist {
  Vector2d v{0, 0};
  double omega = 0;
  Vector2d at(const Vector2d& r) const { return v + omega * perp(r); }
};

/// Of body b in the stacked velocities v of all bodies; the ground's is zero.
inline Twist twist_of(const Eigen::VectorXd& v, BodyId b) {
  if (b < 0) return {};
  return {translation(v, b), rotation(v, b)};
}

/// Row of direction `n` at the point r_a from a's centre and r_b from b's: the rate n · (v_A − v_B).
inline Row pair_row(BodyId a, BodyId b, const Vector2d& n, const Vector2d& r_a, const Vector2d& r_b) {
  return {a, b, {n.x(), n.y(), cross(r_a, n)}, {-n.x(), -n.y(), -cross(r_b, n)}};
}

/// Poses and twists of all bodies, with the ground behind index kGround.
template <> struct KinematicsOf<Planar> {
  struct Node {  // of a grid of angles; none at first
    double theta = std::numeric_limits<double>::quiet_NaN(), c = 0, s = 0;
  };
  std::vector<Pose> pose;    // bodies + 1; the last is the ground
  std::vector<Twist> twist;  // likewise; filled when velocities are requested
  std::vector<Node> node;    // a body's angle is near to (set_poses)
  double t = 0;              // [s] what driving constraints read
  const Pose& at(BodyId i) const { return i < 0 ? pose.back() : pose[static_cast<std::size_t>(i)]; }
  const Twist& rate(BodyId i) const { return i < 0 ? twist.back() : twist[static_cast<std::size_t>(i)]; }
};
using Kinematics = KinematicsOf<Planar>;

/// Likewise; the plane does not need the pose in `at`.
inline Twist twist_of(const Eigen::VectorXd& v, BodyId b, const Kinematics& /*at*/) { return twist_of(v, b); }

}  // namespace orthant
