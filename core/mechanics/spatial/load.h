// core/mechanics/spatial/load.h — applied loads: a force at a point of a body and a moment, in the world's frame or in
// the body's, constant or given in time.
#pragma once

#include <orthant/core/mechanics/spatial/geometry.h>

#include <functional>
#include <string>
#include <vector>

namespace orthant::spatial {

enum class Frame { world, body };

/// force(t) = force · factor(t), likewise moment; an empty factor means 1.
struct Load {
  std::string name;
  BodyId body = 0;
  Vector3d point{0, 0, 0};   // [m] in the body's frame
  Vector3d force{0, 0, 0};   // [N] in `frame`
  Vector3d moment{0, 0, 0};  // [N m] in `frame`
  Frame frame = Frame::world;
  std::function<double(double)> factor;
  std::vector<double> breakpoints;  // [s] ascending: where factor or its slope jumps
  double omega = 0;                 // [rad/s] of the fastest swing of factor

  void add(const Kinematics& k, double t, double* f) const {
    const double scale = factor ? factor(t) : 1.0;
    const Pose& pose = k.at(body);
    const auto in_world = [&](const Vector3d& x) { return frame == Frame::body ? pose.turn(x) : x; };
    const Vector3d F = scale * in_world(force), M = scale * in_world(moment) + pose.turn(point).cross(F);
    Eigen::Map<Eigen::Matrix<double, 6, 1>> sum(f + Spatial::kVelocities * body);
    sum.head<3>() += F, sum.tail<3>() += pose.axes.transpose() * M;
  }
};

}  // namespace orthant::spatial
