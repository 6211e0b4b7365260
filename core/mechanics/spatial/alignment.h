// core/mechanics/spatial/alignment.h — misalignment of a joint's bodies: the least turn of b against a that removes it.
//
//   Joints keep directions at right angles (constraint.h, Square). These equations hold for opposite axes, too, and for
//   a body turned by half a turn. They have no gradient where axes are at right angles that should be parallel, or the
//   other way round. The rotation vector to the next aligned pose has neither fault:
//     axes u_a, u_b parallel      θ k,  k = u_b × u_a / |u_b × u_a|,  θ = angle between them; opposite: any k ⊥ u_a
//     axes at right angles        (π/2 − θ) k,  k = u_a × u_b / |u_a × u_b|;  parallel: any k ⊥ u_a
//     one orientation, O          the rotation vector of R_a O R_bᵀ
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace orthant::spatial {

struct Alignment {
  BodyId a = kGround, b = kGround;
  int row = 0, rows = 0;               // of the joint: those that keep directions at right angles
  Vector3d turn{0, 0, 0};              // [rad] rotation vector of b against a, in the world
  std::array<Vector3d, 3> about = {};  // a direction for each of the rows, in the world

  /// Row i: the rate about `about[i]`.
  Row rate(const Kinematics& k, int i) const { return turn_row(k, b, a, about[static_cast<std::size_t>(i)]); }
  double missing(int i) const { return about[static_cast<std::size_t>(i)].dot(turn); }
};

/// The unit vector along u × w, and the angle between the two; parallel ones: any direction at right angles to u.
inline Eigen::AngleAxisd turn_between(const Vector3d& u, const Vector3d& w) {
  const Vector3d n = u.cross(w);
  const double sine = n.norm();
  return {std::atan2(sine, u.dot(w)), sine > 1e-9 ? Vector3d(n / sine) : perpendicular(u)};
}

/// Calls f(alignment) if the joint keeps directions.
template <class F> void with_alignment(const Joint& joint, const Kinematics& k, F&& f) {
  std::visit(
      [&](const auto& j) {
        using Kind = std::decay_t<decltype(j)>;
        if constexpr (
            requires { j.orientation; } || requires { j.axis_a; }) {
          Alignment one{j.a, j.b};
          int row = 0;
          j.each([&](const auto& equation) {
            using Equation = std::decay_t<decltype(equation)>;
            if constexpr (std::is_same_v<Equation, Square> || std::is_same_v<Equation, Parallel>) {
              if (one.rows == 0) one.row = row;
              one.rows += equation.kRows;
            }
            row += equation.kRows;
          });
          if constexpr (requires { j.orientation; }) {
            const Matrix3d whole = k.at(j.a).R * quaternions::matrix_of(j.orientation) * k.at(j.b).R.transpose();
            const Eigen::AngleAxisd turn(whole);
            one.turn = turn.angle() * turn.axis();
            for (int i = 0; i < 3; ++i) one.about[static_cast<std::size_t>(i)] = Vector3d::Unit(i);
          } else {
            const Vector3d u = k.at(j.a).turn(j.axis_a), w = k.at(j.b).turn(j.axis_b);
            const Eigen::AngleAxisd between = turn_between(u, w);
            const double wanted = std::is_same_v<Kind, Universal> ? std::numbers::pi / 2 : 0;
            one.turn = (wanted - between.angle()) * between.axis();
            one.about = {between.axis(), u.cross(between.axis())};
          }
          f(one);
        }
      },
      joint);
}

}  // namespace orthant::spatial
