// core/mechanics/spatial/drag.h — drag of a medium at rest on a body, linear and quadratic; a damper along one axis.
//
//   Force −(c + c₂ |u|) u at a point with the velocity u, or moment −(c + c₂ |ω|) ω, in the world. Each of the three
//   axes is one element, a spring without stiffness (spring.h): tension T = (c + c₂ |u|) u_i along the row of u_i.
//   scene.spring_set(drag("air", body, {.linear = 0.1, .quadratic = 0.02}));
// To first order ΔT = (c + c₂ |u|) row Δv: the share of c₂ that |u| has is left out, so that schemes of order 2 have
// order 1 where c₂ > 0. Where h c / m is large, velocities swing from step to step, with θ = 1 they do not.
#pragma once

#include <orthant/core/mechanics/spatial/spring.h>

#include <string>
#include <vector>

namespace orthant::spatial {

struct Drag {
  std::string name;
  BodyId a = kGround, b = kGround;  // the body; the medium rests against the ground
  Vector3d point{0, 0, 0};          // [m] in the body's frame
  int component = 0;                // of the world: 0 x, 1 y, 2 z
  bool turning = false;             // against the angular velocity
  double damping = 0;               // c: [N s/m] or [N m s] ≥ 0
  double quadratic = 0;             // c₂: [N s²/m²] or [N m s²] ≥ 0
  static constexpr double stiffness = 0, rest = 0;

  SpringState evaluate(const Kinematics& k, const double* v) const {
    const Vector3d unit = Vector3d::Unit(component), r = k.at(a).turn(point);
    SpringState s{turning ? turn_row(k, a, b, unit) : pair_row(k, a, b, unit, r, Vector3d::Zero())};
    s.damping = damping;
    if (quadratic > 0) {
      const Eigen::Map<const Vector3d> centre(v + Spatial::kVelocities * a), spin(v + Spatial::kVelocities * a + 3);
      const Vector3d omega = k.at(a).axes.lazyProduct(spin);
      s.damping += quadratic * (turning ? omega : Vector3d(centre + omega.cross(r))).norm();
    }
    s.tension = s.damping * apply(s.row, v);
    return s;
  }
};

struct DragLaw {
  Vector3d point{0, 0, 0};                    // [m] in the body's frame: where the force acts
  double linear = 0, quadratic = 0;           // [N s/m], [N s²/m²]
  double angular = 0, angular_quadratic = 0;  // [N m s], [N m s²]
};

/// The elements that are not zero: NAME_x, NAME_y, NAME_z of the force, NAME_wx, NAME_wy, NAME_wz of the moment.
inline std::vector<Drag> drag(const std::string& name, BodyId body, const DragLaw& law) {
  std::vector<Drag> all;
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, "xyz"[i]);
    if (law.linear != 0 || law.quadratic != 0)
      all.push_back({name + "_" + axis, body, kGround, law.point, i, false, law.linear, law.quadratic});
    if (law.angular != 0 || law.angular_quadratic != 0)
      all.push_back({name + "_w" + axis, body, kGround, {0, 0, 0}, i, true, law.angular, law.angular_quadratic});
  }
  return all;
}

}  // namespace orthant::spatial
