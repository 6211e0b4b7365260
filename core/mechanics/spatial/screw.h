// core/mechanics/spatial/screw.h — screw joint: body b turns about an axis of body a and advances along it.
//   Φ = [ t1 · (P_b − P_a);  t2 · (P_b − P_a);  t1 · u_b;  t2 · u_b;  s − offset − (pitch / 2π) θ ] = 0   [m, 1]
//   s, θ: displacement and angle of a cylindrical joint. A turn more is a pitch more, and θ is known up to turns: of
//   the last residual's values, which differ by a pitch, the one nearest to 0 is taken.
#pragma once

#include <orthant/core/mechanics/spatial/constraint.h>

#include <cmath>
#include <numbers>
#include <string>

namespace orthant::spatial {

/// s − offset − (pitch / 2π) θ of the same two bodies.
struct Advance {
  static constexpr int kRows = 1;
  Angle angle;
  Slide slide;
  double pitch, offset;

  void residual(const Kinematics& k, double* phi) const {
    phi[0] = std::remainder(slide.value(k) - offset - lead() * angle.value(k), pitch);
  }
  void rows(const Kinematics& k, Row* G) const { G[0] = combined(slide.row(k), -lead(), angle.row(k)); }
  void bias(const Kinematics& k, double* Gdot_v) const { Gdot_v[0] = slide.bias(k) - lead() * angle.bias(k); }

 private:
  double lead() const { return pitch / (2 * std::numbers::pi); }
};

struct Screw {
  static constexpr int kRows = 5;
  std::string name;
  BodyId a = kGround, b = kGround;
  Vector3d point_a{0, 0, 0}, point_b{0, 0, 0};          // [m] in the bodies' frames
  Vector3d axis_a{0, 0, 1}, axis_b{0, 0, 1};            // unit vectors in the bodies' frames
  Vector3d reference_a{0, 0, 0}, reference_b{0, 0, 0};  // of the angle, see coordinate.h
  double pitch = 1e-2;                                  // [m] a turn, ≠ 0; > 0: right-handed
  double offset = 0;                                    // [m] displacement at the angle 0
  Vector3d across{0, 0, 0};                             // perpendicular(axis_a); set by System

  template <class F> void each(F&& f) const {
    on_line(a, b, point_a, point_b, axis_a, across, f);
    f(Parallel{a, b, axis_a, axis_b, across});
    f(Advance{angle(), displacement(), pitch, offset});
  }
  void residual(const Kinematics& k, double* phi) const { residual_of(*this, k, phi); }
  void rows(const Kinematics& k, Row* G) const { rows_of(*this, k, G); }
  void bias(const Kinematics& k, double* Gdot_v) const { bias_of(*this, k, Gdot_v); }
  Angle angle() const { return {a, b, axis_a, axis_b, reference_a, reference_b}; }
  Slide displacement() const { return {a, b, point_a, point_b, axis_a}; }
};

}  // namespace orthant::spatial
