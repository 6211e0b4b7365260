// core/mechanics/planar/chain.h — terrain chain: a polyline as convex polygons that act as one surface.
//
//   Scene s;  …
//   s.contact_set(chain_polygon({.name = "ground", .a = car, .corners_a = hull}, {.points = {{0, 0}, {2, 0}, {4,
//   1}}}));
//   for (const Polygon& piece : chain_pieces({.points = profile})) collision.shapes.push_back({.corners = piece});
//
//   Each segment is one piece: its face, and a face behind it at a depth, with ends along the joints' bisectors, which
//   two neighbours share. They are covered, and the joints' inner corners are known as such (exposure.h): no contact
//   has a normal that the surface does not have. Points in a line are one segment.
//   The free side is on the left of the way along the points, unless `free_left` is false: a profile from left to right
//   is a ground, a closed chain counter-clockwise a room, clockwise an island.
//   Bodies that come deeper than half of the depth may come out behind. Where the strip would reach through the chain
//   itself (a thin ridge) it is thinner there.
// Cost: O(n²), once. As shapes of a collision only the pieces near a body are evaluated; as listed contacts all of
// them.
#pragma once

#include <orthant/core/mechanics/planar/disc_polygon.h>
#include <orthant/core/mechanics/planar/polygon_polygon.h>

namespace orthant {

struct GroundChain {
  std::vector<Vector2d> points;  // [m] at least two, three if closed; in the frame of the body that carries it
  bool closed = false;
  bool free_left = true;
  double depth = 0;  // [m] of the strip; 0: a tenth of the chain's extent, or its longest segment if that is more
};

/// One convex polygon a segment, in the order of the points. Throws std::invalid_argument, naming the point, where the
/// chain is none: points that coincide, a turn straight back, segments that cross.
std::vector<Polygon> chain_pieces(const GroundChain& chain);

/// A polygon of `pair.a` against the chain in `pair.b`; pair.corners_b and pair.point are not read. Names: NAME_1_1,
/// NAME_1_2 of the first piece's two points, NAME_2_1, …
std::vector<PolygonPolygon> chain_polygon(const PolygonPolygon& pair, const GroundChain& chain);
/// A disc of `disc.a` likewise; disc.corners is not read. Names: NAME_1, NAME_2, …
std::vector<DiscPolygon> chain_disc(const DiscPolygon& disc, const GroundChain& chain);

}  // namespace orthant
