// core/mechanics/planar/geometry.h — planar poses, and the one row shape that every joint and contact has.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

namespace orthant {

using Vector2d = Eigen::Vector2d;

using BodyId = int;
inline constexpr BodyId kGround = -1;

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

/// One constraint row: its rate is ja · (ẋ, ẏ, ω)_a + jb · (ẋ, ẏ, ω)_b; the ground's part is not read.
/// Every planar joint and contact acts on two bodies at the most, so a Jacobian is a list of these.
struct Row {
  BodyId a = kGround, b = kGround;
  std::array<double, 3> ja{}, jb{};
};

/// Row of direction `n` at the point r_a from a's centre and r_b from b's: the rate n · (v_A − v_B).
inline Row pair_row(BodyId a, BodyId b, const Vector2d& n, const Vector2d& r_a, const Vector2d& r_b) {
  return {a, b, {n.x(), n.y(), cross(r_a, n)}, {-n.x(), -n.y(), -cross(r_b, n)}};
}

/// J v of one row; v is the stacked (ẋ, ẏ, ω) of all bodies.
inline double apply(const Row& row, const double* v) {
  double sum = 0;
  if (row.a >= 0) {
    const double* va = v + 3 * row.a;
    sum += row.ja[0] * va[0] + row.ja[1] * va[1] + row.ja[2] * va[2];
  }
  if (row.b >= 0) {
    const double* vb = v + 3 * row.b;
    sum += row.jb[0] * vb[0] + row.jb[1] * vb[1] + row.jb[2] * vb[2];
  }
  return sum;
}

/// f += Jᵀ λ of one row.
inline void apply_transposed(const Row& row, double lambda, double* f) {
  if (row.a >= 0)
    for (int k = 0; k < 3; ++k) f[3 * row.a + k] += row.ja[static_cast<std::size_t>(k)] * lambda;
  if (row.b >= 0)
    for (int k = 0; k < 3; ++k) f[3 * row.b + k] += row.jb[static_cast<std::size_t>(k)] * lambda;
}

/// Poses and twists of all bodies, with the ground behind index kGround.
struct Kinematics {
  struct Node {  // of a grid of angles; none at first
    double theta = std::numeric_limits<double>::quiet_NaN(), c = 0, s = 0;
  };
  std::vector<Pose> pose;    // bodies + 1; the last is the ground
  std::vector<Twist> twist;  // likewise; filled when velocities are asked for
  std::vector<Node> node;    // a body's angle is near to (set_poses)
  double t = 0;              // [s] what driving constraints read
  const Pose& at(BodyId i) const { return i < 0 ? pose.back() : pose[static_cast<std::size_t>(i)]; }
  const Twist& rate(BodyId i) const { return i < 0 ? twist.back() : twist[static_cast<std::size_t>(i)]; }
};

}  // namespace orthant
