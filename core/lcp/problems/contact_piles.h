// core/lcp/problems/contact_piles.h — contact problems of piled boxes, as one step of a simulation poses them.
//
//   Boxes with masses m_k rest on each other and on the ground; each touching pair of faces has contacts at its corners
//   (planar: two, spatial: four), more than hold it: the normal rows are redundant, A = W M⁻¹ Wᵀ is rank deficient and
//   the forces are not unique, the motion is. Rows N, T (planar) or N, T₁, T₂ (spatial: a square pyramid) a contact;
//   none for friction where μ = 0.   b = W v, v = h (g, 0) the velocity after a step h = 1e-3 s of gravity alone:
//   monotone without friction, and with friction solvable by theory (b lies in the range of W).
//   mass_ratio: heaviest over lightest, growing from bottom to top: iterative methods slow down.
//   slope: gravity's angle, in radians; atan(μ) is where boxes begin to slide.
//   Source: Stewart & Trinkle, Int. J. Numer. Meth. Engng 39 (1996) 2673-2691 (existence).
#pragma once

#include <orthant/core/lcp/problem.h>

namespace orthant {

struct ContactPile {
  double mu = 0.5, mass_ratio = 1, slope = 0;
  bool spatial = false;
  bool discs = false;  // spatial: Coulomb's cone instead of a square pyramid
};

/// One column of cubes of side 1 m; n = boxes × 2 (planar) or 4 (spatial) contacts × rows a contact.
Lcp box_column(Index boxes, const ContactPile& pile);

/// A rigid plate on legs × 1 (planar) or legs × legs (spatial) feet, two loads of mass mass_ratio · 1 kg on its top.
Lcp loaded_table(Index legs, const ContactPile& pile);

/// A wall of `courses` courses of bricks 2 × 1 m, each on the two halves below (planar), courses bricks in the lowest.
Lcp brick_wall(Index courses, const ContactPile& pile);

}  // namespace orthant
