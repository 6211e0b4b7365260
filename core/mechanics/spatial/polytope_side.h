// core/mechanics/spatial/polytope_side.h — one of two polytopes as the other one sees it: heights over its faces, and
// the other's face clipped to the sides of one of them (Sutherland-Hodgman).
#pragma once

#include <orthant/core/mechanics/spatial/exposure.h>
#include <orthant/core/mechanics/spatial/round_shapes.h>

#include <algorithm>
#include <array>
#include <limits>

namespace orthant::spatial {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

using Corners = std::array<Vector3d, kMostHullPoints>;
using Clipped = std::array<Vector3d, 2 * kMostHullPoints>;

/// One of the two polytopes, as the other one sees it.
struct Side {
  const Hull& hull;
  const Hull& other;
  Corners others;  // the other's corners in this frame
  Matrix3d R;      // the other's frame into this one: x → R x + d
  Vector3d d;
  double size;  // [m] of the smaller of the two

  const Vector3d& corner(int i) const { return hull.corners[static_cast<std::size_t>(i)]; }
  const Vector3d& others_corner(int i) const { return others[static_cast<std::size_t>(i)]; }
  /// The other's least height over the plane of a face.
  double gap(const Hull::Face& face) const {
    double least = kUnbounded;
    for (std::size_t i = 0; i < other.corners.size(); ++i) least = std::min(least, face.normal.dot(others[i]));
    return least - face.offset;
  }
  /// Calls what(corner, outward direction along the face) for each side of a face; the directions are no unit vectors.
  template <class What> void each_side(const Hull::Face& face, What&& what) const {
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const Vector3d& p = corner(face.corners[i]);
      const Vector3d along = corner(face.corners[(i + 1) % face.corners.size()]) - p;
      what(p, along.cross(face.normal));
    }
  }
  /// Whether x is over the face, its edges included.
  bool over(const Hull::Face& face, const Vector3d& x) const {
    bool within = true;
    each_side(face, [&](const Vector3d& p, const Vector3d& out) {
      within = within && out.dot(x - p) <= kSamePoint * size * out.norm();
    });
    return within;
  }
};

/// The face of the other that is turned to a face most.
inline const Hull::Face& facing(const Side& s, const Hull::Face& face) {
  const Vector3d n = s.R.transpose() * face.normal;
  const Hull::Face* best = &s.other.faces.front();
  for (const Hull::Face& f : s.other.faces)
    if (f.normal.dot(n) < best->normal.dot(n)) best = &f;
  return *best;
}

/// That face clipped to the sides of the other one; all in the side's frame.
inline std::size_t clipped(const Side& s, const Hull::Face& face, Clipped& polygon) {
  std::size_t count = 0;
  for (const int i : facing(s, face).corners) polygon[count++] = s.others_corner(i);
  Clipped next;
  s.each_side(face, [&](const Vector3d& p, const Vector3d& outward) {
    const Vector3d out = outward.normalized();
    std::size_t kept = 0;
    const auto keep = [&](const Vector3d& x) {
      if (kept < next.size()) next[kept++] = x;
    };
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3d &x = polygon[k], &y = polygon[(k + 1) % count];
      const double at_x = out.dot(x - p), at_y = out.dot(y - p);
      if (at_x <= 0) keep(x);
      if ((at_x < 0 && at_y > 0) || (at_x > 0 && at_y < 0)) keep(x + at_x / (at_x - at_y) * (y - x));
    }
    std::copy_n(next.begin(), kept, polygon.begin());
    count = kept;
  });
  return count;
}

}  // namespace orthant::spatial
