// core/mechanics/planar/chain.h — terrain chain: a polyline as convex polygons that act as one surface.
//
//   Scene s;  …
//   s.contact_set(chain_polygon({.name = "ground", .a = car, .corners_a = hull}, {.points = {{0, 0}, {2, 0}, {4,
//   1}}}));
//   for (const Polygon& piece : chain_pieces({.points = profile})) collision.shapes.push_back({.corners = piece});
//
//   Each segment becomes one convex polygon: the segment itself, a parallel edge behind it at the given depth, and two
//   ends along the bisectors at its points. Neighbours share these ends. At a sharp inner corner both segments go on
//   straight, behind the neighbour: a body in the corner has a contact with each. Ends and inner corners are
//   marked as covered (exposure.h), so that no contact gets a normal that the surface does not have. Collinear points
//   form one segment.
//   The free side is on the left when one walks along the points; with free_left = false it is on the right. So points
//   from left to right form a ground, a closed chain forms a room (counter-clockwise) or an island (clockwise).
//   A body that penetrates deeper than half of the depth may leave on the back. The strip is thinner where it would
//   otherwise pass through the chain itself (a thin ridge).
// Cost: O(n²), once. As shapes of a collision, only the pieces near a body are evaluated. As listed contacts, all are.
#pragma once

#include <orthant/core/mechanics/planar/disc_polygon.h>
#include <orthant/core/mechanics/planar/polygon_polygon.h>

namespace orthant {

struct GroundChain {
  std::vector<Vector2d> points;  // [m] at least two, three if closed; in the frame of the body that carries it
  bool closed = false;
  bool free_left = true;
  double depth = 0;  // [m] of the strip; 0: a tenth of the chain's extent, at least its longest segment
};

/// One convex polygon per segment, in the order of the points. Throws std::invalid_argument, which names the point, if
/// points coincide, the chain turns straight back, or segments cross.
std::vector<Polygon> chain_pieces(const GroundChain& chain);

/// A polygon of `pair.a` against the chain in `pair.b`; pair.corners_b and pair.point are not read. Names: NAME_1_1,
/// NAME_1_2 of the first piece's two points, NAME_2_1, …
std::vector<PolygonPolygon> chain_polygon(const PolygonPolygon& pair, const GroundChain& chain);
/// A disc of `disc.a` likewise; disc.corners is not read. Names: NAME_1, NAME_2, …
std::vector<DiscPolygon> chain_disc(const DiscPolygon& disc, const GroundChain& chain);

}  // namespace orthant
