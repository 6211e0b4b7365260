// core/mechanics/spatial/round_shapes.h — spheres and capsules (segments with a radius): nearest and contact points.
// Source: Ericson, Real-Time Collision Detection (2005), 5.1.9 (two segments).
#pragma once

#include <orthant/core/mechanics/spatial/touch.h>

#include <algorithm>
#include <array>
#include <utility>

namespace orthant::spatial {

inline constexpr double kSamePoint = 1e-9;  // of the size: points of contact so near are one
inline constexpr double kParallel = 1e-6;   // sine of the angle between directions that count as parallel

/// Points p + s (q − p), 0 ≤ s ≤ 1.
struct Segment {
  Vector3d p, q;
  Vector3d at(double s) const { return s < 1 ? Vector3d(p + s * (q - p)) : q; }
  double nearest(const Vector3d& x) const {
    const double square = (q - p).squaredNorm();
    return square > 0 ? std::clamp((x - p).dot(q - p) / square, 0.0, 1.0) : 0;
  }
};

/// s and t of the nearest points of two segments; of parallel ones, at an end of one of them.
std::pair<double, double> nearest(const Segment& a, const Segment& b);

/// Of the nearest points of two cores, grown by their radii. Cores that meet have no normal: z.
TouchPoint grown(const Vector3d& p, double radius_p, const Vector3d& r, double radius_r);

/// Of a sphere or capsule, in the world.
Segment core_of(const Pose& at, const Shape& shape);

/// Adds `count` points in ascending order of their gaps, without those within `same` [m] of another one.
void add_sorted(std::array<TouchPoint, 8>& found, std::size_t count, double same, TouchPoints& points);

/// Two spheres or capsules: the nearest points; of two capsules side by side also the ends of their overlap: at most
/// three points.
TouchPoints touch_round(const Segment& a, double radius_a, const Segment& b, double radius_b);

}  // namespace orthant::spatial
