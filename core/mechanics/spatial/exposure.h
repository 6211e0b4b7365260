// core/mechanics/spatial/exposure.h — internal faces and edges of adjacent polytopes of a body: they have no contacts.
//
//   A face is covered where neighbours lie on all of it. Its edges are internal, too, except ridges: edges at which
//   the surface of both polytopes is convex, as on a roof. n is the normal of the own free face at the edge, n' that of
//   the neighbour's free face, s the direction in that face away from the edge:
//     s · n < 0   a ridge: its normals are those between n and n'. A contact in the direction d belongs to it where
//                 d · s ≤ 0; elsewhere the neighbour's face is nearer.
//     else        a seam in a flat surface, or a valley; a steep one is a step.
//   A seam is flush where free faces of neighbours go on in the plane of the own free face along all of it: `beyond` is
//   set, the edge is covered. Flush faces act as one: what crosses the seam has no corner there.
//   A plane meets a corner of a polytope first only if it also meets it before all neighbours there: their directions
//   from the corner are its `ways`.
// Cost: once; boxes sorted along x, faces of polytopes that touch.
#pragma once

#include <orthant/core/mechanics/spatial/hull.h>

#include <span>

namespace orthant::spatial {

/// Marks covered faces and edges of polytopes of one body, and sets the normals of ridges.
void expose(std::span<Hull* const> hulls);

/// Whether the surface goes on flat past the edge, in neighbours.
inline bool flush(const Hull::Edge& e) { return e.covered && !e.beyond.isZero(0); }

/// Whether a plane that comes to the hull along n, in its frame, meets it before the neighbours there.
bool first_is_free(const Hull& hull, const Vector3d& n);

/// Whether a neighbour goes on from the corner in the plane that meets the hull there along n, in its frame.
bool goes_on(const Hull& hull, std::size_t corner, const Vector3d& n);

/// Whether corner k of a face stays one in the flat surface that neighbours make with the face: all directions from it
/// within that surface are on one side of a line.
bool stays_corner(const Hull& hull, const Hull::Face& face, std::size_t k);

}  // namespace orthant::spatial
