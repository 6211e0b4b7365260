// core/mechanics/planar/polygon_polygon.h — polygon-polygon contact: one of the two points where convex polygons touch.
//
//   The reference face is the one, of either polygon, beyond which the other lies farthest (separating axis); against
//   it stands the other's face at its nearest corner that is turned to it most. Where the two faces lie side by side,
//   the two ends of their overlap are the points: each is a corner of one polygon against the face of the other
//   (corner_wall.h), so that gap, rows and biases are exact and do not depend on which is the reference. Faces tilted
//   by more than kFlat have no overlap to speak of: the points are then the two corners of the face against the
//   reference, of which one is far.
//   Polygons apart, beyond the faces' ends: the distance of two corners.
//   Next to neighbours (exposure.h), an axis that meets a covered face or corner separates, but gives no contact. Where
//   the polygons overlap along the best of these, the contact is along the best free axis. The pair is open, and a
//   neighbour has the contact, if this axis leads past a flat seam, or is deeper than the neighbour's face at a crest.
//   Where the other polygon does not reach that neighbour, the contact is with the plane of its face.
//   The faces' numbers decide which end is point 0: a corner keeps its point when its polygon slides on a face,
//   rocks, or rolls over it, and both gaps are continuous then. Where the contact passes from a corner of one polygon
//   to a corner of the other (a tilted one slides off an edge), and, for an odd number of corners, once a turn, the
//   points change places:
//   the smaller gap is continuous all the same. This does not affect fixed-step schemes. Schemes with a state per
//   contact cannot continue across it (event-driven stops and reports it).
//   Polygons pushed into each other by more than half their width come out on the other side.   O(n_a n_b) a call.
// Source: Ericson, Real-Time Collision Detection (2005), ch. 5; Gregorius, Robust contact creation for physics
// simulations (GDC 2015), for face clipping.
#pragma once

#include <orthant/core/mechanics/planar/corner_wall.h>
#include <orthant/core/mechanics/planar/disc_disc.h>
#include <orthant/core/mechanics/planar/exposure.h>

#include <variant>

namespace orthant {

/// Current contact at point 0 or 1 of two polygons: a corner against a face, or two corners.
using Touch = std::variant<CornerWall, DiscDisc>;
struct Placed {  // a polygon fixed in a body
  BodyId body;
  const Polygon& corners;
  const Exposure* exposed = nullptr;  // among its neighbours in the body; null: all of it
};
Touch touch(const Kinematics& k, const Placed& a, const Placed& b, int point);

struct PolygonPolygon {
  std::string name;
  BodyId a = kGround;
  Polygon corners_a;  // [m] in a's frame
  BodyId b = kGround;
  Polygon corners_b;  // [m] in b's frame
  int point = 0;      // 0 or 1
  ContactLaw law;
  Exposed exposed_a = {}, exposed_b = {};  // set by System

  double gap(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.gap(k); }, touch(k));
  }
  ContactRows rows(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.rows(k); }, touch(k));
  }
  ContactBias bias(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.bias(k); }, touch(k));
  }

  Touch touch(const Kinematics& k) const {
    return orthant::touch(k, {a, corners_a, exposed_a.get()}, {b, corners_b, exposed_b.get()}, point);
  }
};

}  // namespace orthant
