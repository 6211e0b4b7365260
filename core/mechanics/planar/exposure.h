// core/mechanics/planar/exposure.h — internal edges: finds the faces and corners of adjacent polygons of a body that
// can have contacts.
//
//   Tiles that lie flush form one surface. A body that slides over it must not collide with the end face that the
//   neighbour covers, nor with a corner on the seam (a "ghost collision"). A face is covered where other solids of the
//   same body lie against it. At a corner the solids fill sectors; the free sector decides:
//     free angle > π:  a convex corner of the surface, with the normals between those of the two edges of the free
//                      sector
//     else:            a point of a flat surface or a concave corner, which has no normals but those of its
//                      faces.
//   What overlaps a polygon by little next to a crest may have no free axis of small depth there. The contact is then a
//   neighbour's. The cone's normals tell how deep it is below the neighbour's face.
//   Solids count as flush within kFlush of a polygon's size.
// Cost: O(n²) boxes, once, for n solids of a body; faces of those that touch.
// Source: Ericson, Real-Time Collision Detection (2005), ch. 5 (Voronoi regions of features).
#pragma once

#include <orthant/core/mechanics/planar/polygon.h>

#include <memory>
#include <span>

namespace orthant {

inline constexpr double kFlat = 0.1;        // sine of the tilt of two faces that lie against each other
inline constexpr double kFlush = 1e-6;      // of the shortest face: solids this near lie flush
inline constexpr double kAside = 1.0 / 16;  // likewise: how far a contact off the ends of a free face is open
inline constexpr double kCovered = 1e6;     // likewise: a contact with a polygon that is covered all around

/// Of one polygon, in its body's frame.
struct Exposure {
  struct Cone {           // of outward normals, counter-clockwise from `from` to `to`, by less than π
    bool convex = false;  // of the surface; false: none
    bool flat = false;    // the surface goes on in the plane of the face that ends here
    double apart = 0;     // [m] at most, from the neighbours that meet the corner
    Vector2d from{0, 0}, to{0, 0};
  };
  struct Face {
    bool free = true;  // some part of it
    Vector2d normal{0, 0};
  };
  std::vector<Face> face;
  std::vector<Cone> corner;

  /// The corner is the nearest point for something in direction d (unit).
  bool points_to(std::size_t at, const Vector2d& d) const {
    constexpr double kTilt = 1e-9;  // sine
    const Cone& c = corner[at];
    return c.convex && cross(c.from, d) >= -kTilt && cross(d, c.to) >= -kTilt && d.dot(c.from + c.to) > 0;
  }
  /// A face of the outward normal −n may refer to this corner: as a convex one, or as the end of a free face that it
  /// lies against, tilted by less than kFlat.
  bool admits(std::size_t at, const Vector2d& n) const {
    const auto flat = [&](const Face& f) {
      return f.free && n.dot(f.normal) > 0 && std::abs(cross(f.normal, n)) <= kFlat;
    };
    return points_to(at, n) || flat(face[at]) || flat(face[at ? at - 1 : face.size() - 1]);
  }
};
using Exposed = std::shared_ptr<const Exposure>;  // null: all of the polygon, which stands alone

/// Other solid part of the body: a polygon, or the half-plane behind a wall.
struct Solid {
  const Polygon* polygon = nullptr;  // null: a half-plane
  Vector2d point{0, 0}, normal{0, 1};
};

/// Of the polygon `solids[which]`; null where nothing touches it.
Exposed exposure(std::span<const Solid> solids, std::size_t which);

}  // namespace orthant
