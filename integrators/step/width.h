// integrators/step/width.h — width of a shape: the least distance of parallel lines or planes that enclose it. [m]
#pragma once

#include <orthant/core/mechanics/planar/collision.h>
#include <orthant/core/mechanics/spatial/collision.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {

inline double width_of(const Polygon& corners) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    double high = 0;
    const Vector2d normal = outward(corners, i);
    for (const Vector2d& corner : corners) high = std::max(high, std::abs(normal.dot(corner - corners[i])));
    least = std::min(least, high);
  }
  return least;
}
inline double width_of(const Shape& s) { return s.corners.empty() ? 2 * s.radius : width_of(s.corners); }

inline double width_of(const spatial::Shape& s) {
  if (!s.polytope()) return 2 * s.radius;
  double least = std::numeric_limits<double>::infinity();
  for (const spatial::Hull::Face& face : s.hull->faces) {
    double high = 0;
    for (const Vector3d& corner : s.hull->corners) high = std::max(high, face.offset - face.normal.dot(corner));
    least = std::min(least, high);
  }
  return least;
}

}  // namespace orthant
