// core/mechanics/spatial/rotation.h — quaternions: rotations, their exponential, logarithm and update (turned()); steps
// apply it by move() of blocks.h.
//
//   Quaternion (w, x, y, z), |·| = 1, turns the body's frame into the world's.  Rotation vector φ: |φ| [rad] about φ.
//   exp φ = (cos |φ|/2, sin(|φ|/2) φ/|φ|),   log its inverse with |φ| ≤ π
//   turned(p, φ) = p exp φ: a further turn by φ in the body's frame;   turn_between(p, p') = log(p⁻¹ p')
// The product of unit quaternions is divided by its length: rounding does not grow.
// Source: Solà, Deray & Atchuthan, A micro Lie theory for state estimation in robotics (2018), app. B.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace orthant::quaternions {

/// (w, x, y, z) of the rotation vector φ [rad].
template <class Phi> Eigen::Vector4d exponential(const Eigen::MatrixBase<Phi>& phi) {
  const double square = phi.squaredNorm(), s = square / 4;
  double share = 0, w = 0;  // sin(a/2)/a and cos(a/2)
  if (square < 0.04) {      // the next terms of the series are below 3e-18
    share = 0.5 * (1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72))));
    w = 1 - s / 2 * (1 - s / 12 * (1 - s / 30 * (1 - s / 56 * (1 - s / 90))));
  } else {
    const double angle = std::sqrt(square);
    share = std::sin(angle / 2) / angle, w = std::cos(angle / 2);
  }
  return {w, share * phi[0], share * phi[1], share * phi[2]};
}

/// p p', both (w, x, y, z).
template <class P, class Q> Eigen::Vector4d product(const Eigen::MatrixBase<P>& p, const Eigen::MatrixBase<Q>& q) {
  return {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
          p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
}

template <class P> Eigen::Vector4d inverse(const Eigen::MatrixBase<P>& p) { return {p[0], -p[1], -p[2], -p[3]}; }

/// Rotation vector [rad] of p = (w, x, y, z), the shorter way round.
template <class P> Eigen::Vector3d logarithm(const Eigen::MatrixBase<P>& p) {
  const double sign = p[0] < 0 ? -1 : 1;
  const Eigen::Vector3d v(sign * p[1], sign * p[2], sign * p[3]);
  const double sine = v.norm(), cosine = sign * p[0];
  if (sine < 1e-8) return 2 * v;  // 2 v (1 + |v|²/6 …)
  return 2 * std::atan2(sine, cosine) / sine * v;
}

/// p, turned further by φ in the body's frame.
template <class P, class Phi> Eigen::Vector4d turned(const Eigen::MatrixBase<P>& p, const Eigen::MatrixBase<Phi>& phi) {
  const Eigen::Vector4d next = product(p, exponential(phi));
  return next / next.norm();
}

/// The φ with turned(p0, φ) = ±p1.
template <class P, class Q>
Eigen::Vector3d turn_between(const Eigen::MatrixBase<P>& p0, const Eigen::MatrixBase<Q>& p1) {
  return logarithm(product(inverse(p0), p1));
}

/// R of p = (w, x, y, z): world = R body.
template <class P> Eigen::Matrix3d matrix_of(const Eigen::MatrixBase<P>& p) {
  return Eigen::Quaterniond(p[0], p[1], p[2], p[3]).toRotationMatrix();
}

}  // namespace orthant::quaternions
