// core/mechanics/spatial/round_polytope.h — contact points of a sphere or capsule and a convex polytope.
//
//   Core (point or segment) outside of the polytope: the core's point nearest to it, the core's ends, and the points at
//   which the core leaves the space over the face or edge that it lies on. Each is the centre of a sphere: that touches
//   at the polytope's point nearest to it.
//   Core through the polytope: the axis of least overlap among the normals of the faces and the products of the core
//   with the edges; the point of least overlap, and the other end of the core's part over the face there.
//   The least gap is the signed distance of core and polytope less the radius: it changes by no more than the shapes
//   move. Next to neighbours in the same body (exposure.h), what is nearest to a covered face or edge has no point, and
//   of a core through the polytope the part past covered faces is the neighbours'.
// Cost: O(faces · corners) for each point, O(edges).
// Source: Ericson, Real-Time Collision Detection (2005), 5.1 (nearest points), 5.2.1 (axes), 5.3.8 (segment, polytope).
#pragma once

#include <orthant/core/mechanics/spatial/round_shapes.h>

namespace orthant::spatial {

/// All in the polytope's frame.
TouchPoints touch_core(const Segment& core, double radius, const Hull& hull);

}  // namespace orthant::spatial
