// core/mechanics/planar/polygon.h — convex polygons fixed in bodies.
#pragma once

#include <orthant/core/mechanics/planar/geometry.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace orthant {

/// Corners [m] in the body's frame, counter-clockwise, each a strict left turn; at least three. Face i runs from corner
/// i to the next one.
using Polygon = std::vector<Vector2d>;

inline std::size_t next(const Polygon& p, std::size_t i) { return i + 1 < p.size() ? i + 1 : 0; }
inline Vector2d direction(const Polygon& p, std::size_t face) { return (p[next(p, face)] - p[face]).normalized(); }
/// Unit vector out of the polygon.
inline Vector2d outward(const Polygon& p, std::size_t face) { return -perp(direction(p, face)); }

/// Whether these are the corners of a convex polygon as above.
inline bool convex(const Polygon& p) {
  if (p.size() < 3) return false;
  double turned = 0;  // [rad] along the boundary: one turn, or it crosses itself
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector2d here = p[next(p, i)] - p[i], then = p[next(p, next(p, i))] - p[next(p, i)];
    if (!(cross(here, then) > 0)) return false;
    turned += std::atan2(cross(here, then), here.dot(then));
  }
  return turned < 7;
}

/// [m] Of the shortest face.
inline double shortest_face(const Polygon& p) {
  double least = (p.front() - p.back()).squaredNorm();
  for (std::size_t i = 1; i < p.size(); ++i) least = std::min(least, (p[i] - p[i - 1]).squaredNorm());
  return std::sqrt(least);
}

inline Polygon rectangle(double width, double height) {
  const double x = width / 2, y = height / 2;
  return {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
}

}  // namespace orthant
