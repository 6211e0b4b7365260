// core/mechanics/spatial/solid.h — volume and inertia of homogeneous solids about their centres of mass.
//
//   const Solid rod = cylinder(0.01, 1);
//   scene.body({.mass = 7800 * rod.volume, .inertia = 7800 * rod.volume * rod.inertia});
// Axis of capsule, cylinder and cone: z. Lengths [m] > 0.
// Source: any handbook of mechanics; the capsule: two half-balls moved by the parallel axis theorem.
#pragma once

#include <orthant/core/mechanics/blocks.h>

#include <numbers>

namespace orthant::spatial {

struct Solid {
  double volume = 0;        // [m³]
  Eigen::Matrix3d inertia;  // [m²] of 1 kg
};

inline Solid box(const Vector3d& size) {
  const Vector3d s = size.cwiseAbs2();
  return {size.prod(), (Vector3d(s.y() + s.z(), s.z() + s.x(), s.x() + s.y()) / 12).asDiagonal()};
}
inline Solid ellipsoid(const Vector3d& semi_axes) {
  const Vector3d s = semi_axes.cwiseAbs2();
  return {4 * std::numbers::pi / 3 * semi_axes.prod(),
          (Vector3d(s.y() + s.z(), s.z() + s.x(), s.x() + s.y()) / 5).asDiagonal()};
}
inline Solid sphere(double radius) { return ellipsoid({radius, radius, radius}); }
inline Solid cylinder(double radius, double height) {
  const double across = radius * radius / 4 + height * height / 12;
  return {std::numbers::pi * radius * radius * height, Vector3d(across, across, radius * radius / 2).asDiagonal()};
}
/// A cylinder of this length with two half-balls at its ends.
inline Solid capsule(double radius, double length) {
  const double r2 = radius * radius, middle = std::numbers::pi * r2 * length,
               ends = 4.0 / 3 * std::numbers::pi * r2 * radius;
  const double across =
      middle * (r2 / 4 + length * length / 12) + ends * (2 * r2 / 5 + length * length / 4 + 3 * length * radius / 8);
  const double along = middle * r2 / 2 + ends * 2 * r2 / 5, volume = middle + ends;
  return {volume, Vector3d(across / volume, across / volume, along / volume).asDiagonal()};
}
/// Its centre of mass is height / 4 above the base.
inline Solid cone(double radius, double height) {
  const double r2 = radius * radius, across = 3 * (r2 / 20 + height * height / 80);
  return {std::numbers::pi * r2 * height / 3, Vector3d(across, across, 0.3 * r2).asDiagonal()};
}

}  // namespace orthant::spatial
