// solvers/pivoting/extreme_equilibria.h — all extreme equilibria of a bimatrix game, by exact vertex enumeration.
//
//   Costs A, B (m × k), shifted to be > 0 (which changes no equilibrium).  Best-response polyhedra
//     X = { x ∈ Rᵐ : x ≥ 0, Bᵀx ≥ e },   Y = { y ∈ Rᵏ : y ≥ 0, A y ≥ e }
//   have the label i where x_i = 0 or (A y)_i = 1, and the label m + j where (Bᵀx)_j = 1 or y_j = 0.
//   (x, y), scaled to sums of 1, is an extreme equilibrium exactly when both are vertices and together have all labels.
//   Every equilibrium is a convex combination of extreme ones: the equilibria are the union of the products
//   hull(U) × hull(V) over the maximal sets U, V with all pairs of U × V extreme equilibria. A game of which every
//   vertex has as many labels as its polyhedron has dimensions has finitely many equilibria, all of them extreme.
//   Vertices come from the double description method in rationals (core/lcp/judge/exact.h): no tolerance anywhere.
//   Cost: the number of vertices, up to about 2.6ⁿ for n strategies a player; 6 × 6 takes milliseconds.
//   Source: Avis, Rosenberg, Savani & von Stengel, Enumeration of Nash equilibria, Econ. Theory 42 (2010) 9-37.
#pragma once

#include <orthant/solvers/pivoting/lemke_howson.h>

namespace orthant {

struct ExtremeEquilibria {
  std::vector<Equilibrium> all;  // label: the connected component of the set of equilibria, from 0 on
  int components = 0;
  bool complete = true;  // false: stopped; nothing is in it then
};

/// Strategies are the exact ones rounded once; pairs in the order of their supports. `stop` is polled.
/// Throws std::invalid_argument for bad shapes, numbers that are not finite, more than 64 strategies in all.
ExtremeEquilibria extreme_equilibria(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                     const std::function<bool()>& stop = {});

}  // namespace orthant
