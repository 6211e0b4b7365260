// core/mechanics/spatial/hull.h — convex hull of a few points: corners, faces, edges.
#pragma once

#include <orthant/core/mechanics/blocks.h>

#include <vector>

namespace orthant::spatial {

struct Hull {
  struct Face {
    Vector3d normal;           // unit, outwards
    double offset = 0;         // [m] normal · x = offset on the face
    std::vector<int> corners;  // counter-clockwise, seen from outside
    std::vector<int> edges;    // from each corner to the next
    bool covered = false;      // a neighbour in the same body lies on all of it: nothing can touch it
  };
  struct Edge {
    int from = 0, to = 0;     // corners
    int left = 0, right = 0;  // faces; `left` runs through the edge from `from` to `to`
    bool covered = false;     // one of its faces is, and the edge is no ridge (exposure.h)
    bool step = false;        // covered, and the neighbour rises there steeply over the face that is free
    Vector3d left_normal{0, 0, 0},
        right_normal{0, 0, 0};  // of the surface on both sides: of a ridge a neighbour's, too
    Vector3d beyond{0, 0, 0};   // of a ridge: in the neighbour's face, away from the edge

    /// Whether it can be touched in the direction d from it.
    bool meets(const Vector3d& d) const { return !covered && d.dot(beyond) <= 0; }
  };
  std::vector<Vector3d> corners;  // [m] those of the hull, in the order of the points
  std::vector<Face> faces;
  std::vector<Edge> edges;
  bool any_covered = false;
  /// Of each corner: directions along which neighbours reach from it, those that span their cones; empty without any.
  std::vector<std::vector<Vector3d>> ways;
  double size = 0;  // [m] largest |coordinate| about the mean of the corners

  /// The largest of normal · p − offset over the faces: < 0 inside.
  double depth_of(const Vector3d& p) const;
};

inline constexpr std::size_t kMostHullPoints = 64;

/// Points are one plane's corners when they lie within 1e-9 of the hull's size of it; points inside are dropped.
/// Throws std::invalid_argument: fewer than 4 points or more than kMostHullPoints, points of one plane,
/// lengths beyond 1e±60 m.   O(n⁴), mostly O(n³): a plane is left as soon as points lie on both sides of it.
Hull hull_of(const std::vector<Vector3d>& points);

struct FittedHull {
  Hull hull;
  double outside = 0;  // [m] of the points the farthest from the hull, along a face's normal
};
/// Hull of any number of points, with at most `most` corners: the hull itself where it has no more. Otherwise corners
/// are added where points lie farthest outside, until there are that many. Throws std::invalid_argument as hull_of.
/// Source: Barber, Dobkin & Huhdanpaa, The Quickhull algorithm for convex hulls (1996), sec. 4: the farthest point.
FittedHull fit_hull(const std::vector<Vector3d>& points, std::size_t most = kMostHullPoints);

/// Of points in one plane, to 1e-9 of their size: the corners of their hull, counter-clockwise about a normal. Empty
/// where they lie in one line.
std::vector<Vector3d> flat_hull(const std::vector<Vector3d>& points);

}  // namespace orthant::spatial
