// core/mechanics/planar/load.h — applied loads: a force at a point of a body and a torque, constant or given in time.
#pragma once

#include <orthant/core/mechanics/planar/geometry.h>

#include <functional>
#include <string>
#include <vector>

namespace orthant {

/// force(t) = force · factor(t), likewise torque; an empty factor means 1. The force keeps its world direction.
/// Schemes that choose their own steps look at factor only here and there: they stop at its breakpoints.
struct Load {
  std::string name;
  BodyId body = 0;
  Vector2d point{0, 0};  // [m] in the body's frame
  Vector2d force{0, 0};  // [N] in the world's frame
  double torque = 0;     // [N m]
  std::function<double(double)> factor;
  std::vector<double>
      breakpoints;   // [s] ascending: where factor or its slope jumps (factor(t) is what holds from t on)
  double omega = 0;  // [rad/s] of the fastest swing of factor: such schemes look several times a swing

  void add(const Kinematics& k, double t, double* f) const {
    const double scale = factor ? factor(t) : 1.0;
    f[kBlock * body] += scale * force.x();
    f[kBlock * body + 1] += scale * force.y();
    f[kBlock * body + 2] += scale * (torque + cross(k.at(body).turn(point), force));
  }
};

}  // namespace orthant
