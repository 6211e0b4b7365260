// core/mechanics/spatial/polytope_polytope.h — contact points of two convex polytopes (separating axis theorem).
//
//   The axis of least overlap or widest gap among the normals of their faces and the products of their edges. A face:
//   the other's face that is turned to it most is clipped to its sides, and the points are the deepest corner of the
//   clipped face and the three corners that span most. Two edges: one point.
//   Polytopes apart, where neither stands on the other along that axis: the nearest points, their distance.
//   Next to neighbours in the same body (exposure.h), axes of covered faces and edges give no contact. Where the
//   polytopes overlap least along one of these, a contact is along an axis at which one of them stands on the other.
//   Where there is no such axis, a neighbour has the contact. Flush faces of neighbours have the points of the one face
//   that they make: each those of its corners and crossed lines that lie over it, none at seams between them.
// Cost: O(faces · corners + edges²) a call; polytopes apart and beside each other's faces: three times that.
// Source: Ericson, Real-Time Collision Detection (2005), ch. 5; Gregorius, The separating axis test between convex
// polyhedra (GDC 2013).
#pragma once

#include <orthant/core/mechanics/spatial/touch.h>

namespace orthant::spatial {

/// Two polytopes whose frames differ by x → R x + d, b's into a's; the points in a's frame.
TouchPoints touch_polytopes(const Hull& a, const Hull& b, const Matrix3d& R, const Vector3d& d);

}  // namespace orthant::spatial
