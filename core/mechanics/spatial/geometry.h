// core/mechanics/spatial/geometry.h — spatial poses and twists, and the row of a direction at two points.
//
//   Row of a world direction n at the point r from a body's centre: (n, Aᵀ (r × n)), A: principal axes → world,
//   because ω in v stands in the principal axes. Points and directions of a body are given in its own frame, R.
#pragma once

#include <orthant/core/mechanics/rows.h>

#include <vector>

namespace orthant {
namespace spatial {

using Row = RowOf<Spatial>;
using Matrix3d = Eigen::Matrix3d;

/// M p and Mᵀ p, written out: the compiler makes calls of Eigen's products, 10 % of a step.
[[gnu::always_inline]] inline Vector3d product(const Matrix3d& M, const Vector3d& p) {
  const double x = p.x(), y = p.y(), z = p.z();
  return {M(0, 0) * x + M(0, 1) * y + M(0, 2) * z, M(1, 0) * x + M(1, 1) * y + M(1, 2) * z,
          M(2, 0) * x + M(2, 1) * y + M(2, 2) * z};
}
[[gnu::always_inline]] inline Vector3d transposed_product(const Matrix3d& M, const Vector3d& p) {
  const double x = p.x(), y = p.y(), z = p.z();
  return {M(0, 0) * x + M(1, 0) * y + M(2, 0) * z, M(0, 1) * x + M(1, 1) * y + M(2, 1) * z,
          M(0, 2) * x + M(1, 2) * y + M(2, 2) * z};
}

/// Place of a body's centre of mass, its own frame and its principal axes as rotation matrices; the ground's are the
/// identity.
struct Pose {
  Vector3d x = Vector3d::Zero();
  Matrix3d R = Matrix3d::Identity(), axes = Matrix3d::Identity();
  Vector3d turn(const Vector3d& p) const { return product(R, p); }
  Vector3d turn_back(const Vector3d& p) const { return transposed_product(R, p); }
};

/// Velocity of a body's centre and its angular velocity, both in the world.
struct Twist {
  Vector3d v = Vector3d::Zero(), omega = Vector3d::Zero();
  Vector3d at(const Vector3d& r) const { return v + omega.cross(r); }
};

}  // namespace spatial

template <> struct KinematicsOf<Spatial> {
  std::vector<spatial::Pose> pose;    // bodies + 1; the last is the ground
  std::vector<spatial::Twist> twist;  // likewise; set_twists() fills it
  double t = 0;                       // [s] what driving constraints read
  const spatial::Pose& at(BodyId i) const { return i < 0 ? pose.back() : pose[static_cast<std::size_t>(i)]; }
  const spatial::Twist& rate(BodyId i) const { return i < 0 ? twist.back() : twist[static_cast<std::size_t>(i)]; }
};

namespace spatial {

using Kinematics = KinematicsOf<Spatial>;

/// A unit vector at right angles to the unit vector n: the coordinate axis that is most at right angles to it, less its
/// part along n. Of z: x; of x: y; of y: x.
inline Vector3d perpendicular(const Vector3d& n) {
  const double x = std::abs(n.x()), y = std::abs(n.y()), z = std::abs(n.z());
  const int k = x <= y && x <= z ? 0 : y <= z ? 1 : 2;
  const double length = std::sqrt(n.squaredNorm() - n[k] * n[k]);  // of the part of n across that axis
  Vector3d t = -n[k] / length * n;
  t[k] = length;
  return t;
}

inline Row::Entries entries(const Vector3d& n, const Vector3d& turn) {
  return {n.x(), n.y(), n.z(), turn.x(), turn.y(), turn.z()};
}

/// The rate n · (v_A − v_B) at the points r_a from a's centre and r_b from b's; n, r_a, r_b in the world.
inline Row pair_row(const Kinematics& k, BodyId a, BodyId b, const Vector3d& n, const Vector3d& r_a,
                    const Vector3d& r_b) {
  return {a, b, entries(n, transposed_product(k.at(a).axes, r_a.cross(n))),
          entries(-n, -transposed_product(k.at(b).axes, r_b.cross(n)))};
}
/// pair_row() of the three axes of the world: no product with their zeros.
inline void point_rows(const Kinematics& k, BodyId a, BodyId b, const Vector3d& r_a, const Vector3d& r_b, Row* G) {
  const auto part = [&](BodyId body, double sign, const Vector3d& r, Row::Entries Row::*to) {
    const Matrix3d& A = k.at(body).axes;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, l = (i + 2) % 3;  // r × e_i = r_l e_j − r_j e_l
      Row::Entries& entries = G[i].*to;
      for (int c = 0; c < 3; ++c) {
        entries[static_cast<std::size_t>(c)] = c == i ? sign : 0;
        entries[static_cast<std::size_t>(3 + c)] = sign * (r[l] * A(j, c) - r[j] * A(l, c));
      }
    }
  };
  for (int i = 0; i < 3; ++i) G[i].a = a, G[i].b = b;
  if (a >= 0) part(a, 1, r_a, &Row::ja);
  if (b >= 0) part(b, -1, r_b, &Row::jb);
}
/// The rate n · (ω_a − ω_b).
inline Row turn_row(const Kinematics& k, BodyId a, BodyId b, const Vector3d& n) {
  const auto part = [&](BodyId body, double sign) -> Row::Entries {
    if (body < 0) return {};
    const Vector3d turn = sign * transposed_product(k.at(body).axes, n);
    return {0, 0, 0, turn.x(), turn.y(), turn.z()};
  };
  return {a, b, part(a, 1), part(b, -1)};
}

}  // namespace spatial

/// Of body b in the stacked velocities v of all bodies; the ground's is zero. `at` has its pose.
inline spatial::Twist twist_of(const Eigen::VectorXd& v, BodyId b, const KinematicsOf<Spatial>& at) {
  if (b < 0) return {};
  return {translation<Spatial>(v, b), spatial::product(at.at(b).axes, rotation<Spatial>(v, b))};
}

}  // namespace orthant
