// core/lcp/problems/obstacles.h — obstacle problems on grids: sparse, of any size, with known answers.
//
//   A membrane u is pressed on an obstacle ψ: u ≥ ψ, its load −(Δ u) ≥ f, one of the two equal at each node. The
//   unknown is z = u − ψ ≥ 0; M is a symmetric K-matrix (A_ij ≤ 0 off the diagonal, all principal minors > 0), so that
//   z is unique. n up to 10⁶ takes a second to build. Shared by tests and benchmarks.
#pragma once

#include <orthant/core/lcp/problem.h>

namespace orthant {

/// −u″ + 8 ≥ 0, u ≥ −gap on (0, 1), u = 0 at both ends; h = 1/intervals, n = intervals − 1, z_i = u((i + 1) h) + gap.
/// In contact on [a, 1 − a], a = √(gap)/2, z = 4 (x − a)² left of it: the discrete answer too, where a is a node.
Lcp string_on_obstacle(Index intervals, double gap = 0.25);

/// A beam u on (0, 1), supported at both ends, bent by a uniform load onto a floor: E I u⁗ + 384/5 ≥ 0, E I = 1,
/// u ≥ −gap; without the floor its middle sinks by 1. Cubic Hermite elements, h = 1/elements: rows z = u + gap and
/// h u′ of each node, z first, without z at the ends; n = 2 elements. Slopes are free rows. M is SPD, condition
/// ~ elements⁴.
Lcp beam_on_obstacle(Index elements, double gap = 0.5);

/// Δu ≤ 0 on (−2, 2)² above the upper half ball, ψ = √(1 − r²) for r ≤ 1, else −1; five-point differences of −Δ, at
/// (intervals − 1)² nodes, row by row. At the boundary u is the exact answer: in contact for r ≤ r*, outside
///   u = −r*² ln(r/2) / √(1 − r*²),   r*² (1 − ln(r*/2)) = 1.
struct BallObstacle {
  Lcp problem;
  Vector exact;  // z = u − ψ at the nodes, of the differential equation: O(h²) from the discrete one
};
BallObstacle ball_obstacle(Index intervals);

/// Pressure in a journal bearing: min ½ ∫ (1 + ε cos x)³ |∇v|² − ε ∫ v sin x, v ≥ 0 on (0, 2π) × (0, 2b), v = 0 at the
/// boundary; linear elements on nx × ny interior nodes, x fastest. The minimum is ½ zᵀM z + qᵀz.
/// Source: Averick, Carter, Moré & Xue, The MINPACK-2 test problem collection, ANL/MCS-P153-0692 (1992), 4.2.
Lcp journal_bearing(Index nx, Index ny, double eccentricity = 0.1, double b = 10);

/// −Δu ≥ 0 in (−2, 2)³ above the upper part of a ball: u ≥ ψ, ψ = √(1 − |x|²) in the unit ball, else −1; seven-point
/// differences at (intervals − 1)³ nodes, x fastest. At the boundary u is the exact answer: with r = |x|, in contact
/// for r ≤ r*, outside u = α (1/r − 1/2) of slope ψ' at r*. α and r* follow from
///   ψ(r*) = α (1/r* − 1/2),   ψ'(r*) = −α / r*².
/// M is a symmetric K-matrix.
struct SpaceObstacle {
  Lcp problem;
  Vector exact;    // z = u − ψ of the differential equation: O(h²) from the discrete one
  double rim = 0;  // r*
};
SpaceObstacle space_obstacle(Index intervals);

/// Torsion of an elastic-plastic bar of the cross-section (0, 1)²: min ½ ∫ |∇u|² − twist ∫ u, |u| ≤ distance to the
/// boundary; five-point differences of −Δ at nx × ny interior nodes, x fastest; every row a box. Plastic where u is at
/// its bound.
/// Source: Averick, Carter, Moré & Xue, The MINPACK-2 test problem collection, ANL/MCS-P153-0692 (1992), 4.1.
Lcp elastic_plastic_torsion(Index nx, Index ny, double twist = 5);

}  // namespace orthant
