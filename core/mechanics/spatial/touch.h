// core/mechanics/spatial/touch.h — narrow phase in space: contact points of convex shapes, polytopes and capsules.
//
//   A shape is a point or a segment, grown by a radius (sphere, capsule), or a convex polytope (hull.h).
//   Spheres and capsules: nearest points of the cores; two capsules side by side also touch at the ends of their
//   overlap. Sphere or capsule and polytope: round_polytope.h.
//   Two polytopes: polytope_polytope.h.
//   Points are numbered along a direction that is fixed in a: near poses number them alike, so that iterations within a
//   step and warm starts find the same point under the same number.
//   Every gap ≤ 0 is an overlap. Two shapes overlap exactly where some gap is < 0, unless a neighbour in the same body
//   has the contact: a flush surface acts as one. A gap > 0 between polytopes is at most their distance.
//   Shapes pushed into each other by more than half their width come out on the other side.
// Source: Ericson, Real-Time Collision Detection (2005), ch. 5.
#pragma once

#include <orthant/core/mechanics/spatial/geometry.h>
#include <orthant/core/mechanics/spatial/hull.h>

#include <array>
#include <memory>

namespace orthant::spatial {

struct Shape {
  BodyId body = kGround;
  std::vector<Vector3d> corners;          // [m] in the body's frame: 1 of a sphere, 2 of a capsule, else a polytope's
  double radius = 0;                      // [m] > 0 of a sphere or capsule, 0 of a polytope
  std::shared_ptr<const Hull> hull = {};  // of a polytope; set by System

  bool sphere() const { return corners.size() == 1; }
  bool capsule() const { return corners.size() == 2; }
  bool polytope() const { return corners.size() > 2; }
};

struct TouchPoint {
  Vector3d n{0, 0, 0};                    // unit, from b to a, in the world
  Vector3d on_a{0, 0, 0}, on_b{0, 0, 0};  // [m] in the world
  double gap = 0;                         // [m] n · (on_a − on_b)
};
struct TouchPoints {
  /// Point i; one that there is not is point 0 with the gap `open`.
  TouchPoint at(int i) const {
    if (i < count) return points[static_cast<std::size_t>(i)];
    TouchPoint none = points[0];
    none.gap = open;
    return none;
  }

  static constexpr int kMost = 4;
  int count = 0;
  std::array<TouchPoint, kMost> points;  // [0] has a normal in any case
  double open = 0;  // [m] stands for the gap of points that there are not: the least one and the smaller shape's size
  void add(const TouchPoint& p) {
    if (count < kMost) points[static_cast<std::size_t>(count++)] = p;
  }
};

/// How many points two shapes can have at the most.
int most_points(const Shape& a, const Shape& b);

TouchPoints touch(const Pose& at_a, const Shape& a, const Pose& at_b, const Shape& b);

}  // namespace orthant::spatial
