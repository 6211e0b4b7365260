// core/mechanics/spatial/constraint.h — constraint equations, of which joints consist; each is one row or three.
//
//   Together   Φ = P_a − P_b                        [m] 3 rows
//   Across     Φ = u · (P_b − P_a),  u = R_a axis   [m] 1 row
//   Square     Φ = (R_a u) · (R_b w)                [1] 1 row: two directions stay at right angles
//   Parallel   Φ = R_a (t1, t2) · (R_b w)           [1] 2 rows: w stays along an axis of a; (t1, t2) square to that
// A joint calls f(equation) for each of its own in each(f); the functions at the end make its residual, rows and
// biases.
#pragma once

#include <orthant/core/mechanics/spatial/coordinate.h>

namespace orthant::spatial {

struct Together {
  static constexpr int kRows = 3;
  BodyId a, b;
  Vector3d point_a, point_b;  // [m] in the bodies' frames

  void residual(const Kinematics& k, double* phi) const {
    Eigen::Map<Vector3d>(phi, 3) = k.at(a).x + k.at(a).turn(point_a) - k.at(b).x - k.at(b).turn(point_b);
  }
  void rows(const Kinematics& k, Row* G) const { point_rows(k, a, b, k.at(a).turn(point_a), k.at(b).turn(point_b), G); }
  void bias(const Kinematics& k, double* Gdot_v) const {
    const Vector3d &wa = k.rate(a).omega, &wb = k.rate(b).omega;
    Eigen::Map<Vector3d>(Gdot_v, 3) =
        wa.cross(wa.cross(k.at(a).turn(point_a))) - wb.cross(wb.cross(k.at(b).turn(point_b)));
  }
};

struct Across {
  static constexpr int kRows = 1;
  Slide slide;
  void residual(const Kinematics& k, double* phi) const { phi[0] = slide.value(k); }
  void rows(const Kinematics& k, Row* G) const { G[0] = slide.row(k); }
  void bias(const Kinematics& k, double* Gdot_v) const { Gdot_v[0] = slide.bias(k); }
};

struct Square {
  static constexpr int kRows = 1;
  BodyId a, b;
  Vector3d u, w;  // unit vectors in the bodies' frames

  void residual(const Kinematics& k, double* phi) const { phi[0] = k.at(a).turn(u).dot(k.at(b).turn(w)); }
  /// d/dt (u · w) = (u × w) · (ω_a − ω_b).
  void rows(const Kinematics& k, Row* G) const { G[0] = turn_row(k, a, b, k.at(a).turn(u).cross(k.at(b).turn(w))); }
  void bias(const Kinematics& k, double* Gdot_v) const {
    const Vector3d ua = k.at(a).turn(u), wb = k.at(b).turn(w);
    const Vector3d &oa = k.rate(a).omega, &ob = k.rate(b).omega;
    Gdot_v[0] = oa.cross(oa.cross(ua)).dot(wb) + 2 * oa.cross(ua).dot(ob.cross(wb)) + ua.dot(ob.cross(ob.cross(wb)));
  }
};

struct Parallel {
  static constexpr int kRows = 2;
  BodyId a, b;
  Vector3d axis, w;  // unit vectors in the bodies' frames
  Vector3d across;   // t1 in a's frame; zero: perpendicular(axis)

  void residual(const Kinematics& k, double* phi) const {
    const auto [t, s] = tangents(k);
    const Vector3d wb = k.at(b).turn(w);
    phi[0] = t.dot(wb), phi[1] = s.dot(wb);
  }
  void rows(const Kinematics& k, Row* G) const {
    const auto [t, s] = tangents(k);
    const Vector3d wb = k.at(b).turn(w);
    G[0] = turn_row(k, a, b, t.cross(wb)), G[1] = turn_row(k, a, b, s.cross(wb));
  }
  void bias(const Kinematics& k, double* Gdot_v) const {
    const Vector3d t = first();
    Square{a, b, t, w}.bias(k, Gdot_v), Square{a, b, axis.cross(t), w}.bias(k, Gdot_v + 1);
  }

 private:
  Vector3d first() const { return across.isZero(0) ? perpendicular(axis) : across; }
  std::pair<Vector3d, Vector3d> tangents(const Kinematics& k) const {
    const Vector3d t = first();
    return {k.at(a).turn(t), k.at(a).turn(axis.cross(t))};
  }
};

/// Of a joint with an `across`.
template <class Joint> const Vector3d& axis_of(const Joint& joint) {
  if constexpr (requires { joint.axis_a; })
    return joint.axis_a;
  else
    return joint.axis;
}
/// A unit vector at right angles to the unit vector `axis`, up to rounding.
inline bool square_to(const Vector3d& axis, const Vector3d& t) {
  constexpr double kRounding = 1e-14;
  return std::abs(t.squaredNorm() - 1) <= kRounding && std::abs(t.dot(axis)) <= kRounding;
}

template <class Joint> void residual_of(const Joint& joint, const Kinematics& k, double* phi) {
  joint.each([&](const auto& equation) { equation.residual(k, phi), phi += equation.kRows; });
}
template <class Joint> void rows_of(const Joint& joint, const Kinematics& k, Row* G) {
  joint.each([&](const auto& equation) { equation.rows(k, G), G += equation.kRows; });
}
template <class Joint> void bias_of(const Joint& joint, const Kinematics& k, double* Gdot_v) {
  joint.each([&](const auto& equation) { equation.bias(k, Gdot_v), Gdot_v += equation.kRows; });
}

/// The two equations that keep P_b on the line through P_a along the axis of a. across: as Parallel's.
template <class F> void on_line(BodyId a, BodyId b, const Vector3d& point_a, const Vector3d& point_b,
                                const Vector3d& axis, const Vector3d& across, F&& f) {
  const Vector3d t = across.isZero(0) ? perpendicular(axis) : across;
  f(Across{{a, b, point_a, point_b, t}}), f(Across{{a, b, point_a, point_b, axis.cross(t)}});
}
/// The three equations that keep R_b = R_a O; orientation: quaternion of O, b's frame → a's.
template <class F> void one_orientation(BodyId a, BodyId b, const Eigen::Vector4d& orientation, F&& f) {
  const Matrix3d O = quaternions::matrix_of(orientation);
  for (int i = 0; i < 3; ++i) f(Square{a, b, Vector3d::Unit((i + 1) % 3), O.row(i).transpose()});
}

}  // namespace orthant::spatial
