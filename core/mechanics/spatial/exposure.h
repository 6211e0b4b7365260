// core/mechanics/spatial/exposure.h — internal faces and edges of adjacent polytopes of a body: they have no contacts.
//
//   A face is covered where neighbours lie on all of it. Its edges are internal, too, except ridges: edges at which
//   the surface of both polytopes is convex, as on a roof. n is the normal of the own free face at the edge, n' that of
//   the neighbour's free face, s the direction in that face away from the edge:
//     s · n < 0   a ridge: its normals are those between n and n'. A contact in the direction d belongs to it where
//                 d · s ≤ 0; elsewhere the neighbour's face is nearer.
//     else        a seam in a flat surface, or a valley; a steep one is a step.
//   A plane meets a corner of a polytope first only if it also meets it before all neighbours there: their directions
//   from the corner are its `ways`.
// Cost: once; boxes sorted along x, faces of polytopes that touch.
#pragma once

#include <orthant/core/mechanics/spatial/hull.h>

#include <span>

namespace orthant::spatial {

/// Marks covered faces and edges of polytopes of one body, and sets the normals of ridges.
void expose(std::span<Hull* const> hulls);

}  // namespace orthant::spatial
