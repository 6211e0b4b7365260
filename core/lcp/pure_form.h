// core/lcp/pure_form.h — pure form of an LCP: boxes, shifted bounds, planar friction. Facets of discs: cones/facets.h.
//
//   One-sided:     z = lo + y, or z = hi − y with the row's sign turned.
//   Box [lo, hi]:  z = lo + y,       0 ≤ y ⊥ w + ξ ≥ 0,  0 ≤ ξ ⊥ (hi − lo) − y ≥ 0.
//   Friction:      z_t = y − μ z_n,  0 ≤ y ⊥ w_t + ξ ≥ 0,  0 ≤ ξ ⊥ 2μ z_n − y ≥ 0:  the box with hi = −lo = μ z_n.
//   With the rows N, then T, then the added ξ this is Glocker's planar form, y = Λ_R, ξ = ξ_L:
//     M = [ G_NN − μ G_NT   G_NT   0 ]
//         [ G_TN − μ G_TT   G_TT   I ]
//         [ 2μ I            −I     0 ]
//   A friction row with w_t < 0 at z = lo is turned first (its row and column change sign, z_t = μ z_n − y): then a
//   sliding contact starts at the bound where it ends, added rows never cover anything, and a mirrored problem takes
//   mirrored pivots.
//   stewart_trinkle writes friction as z_t = y⁺ − y⁻ instead, one row more:
//     0 ≤ y± ⊥ ±w_t + λ ≥ 0,  0 ≤ λ ⊥ μ z_n − y⁺ − y⁻ ≥ 0:
//   larger, but copositive when A is positive semidefinite, so that Lemke's method cannot fail on a solvable contact
//   problem for reasons of form.
//   The n given rows keep their places; added rows follow, in the order of the rows they belong to.
//   Sources: Glocker & Studer, Multibody Syst. Dyn. 13 (2005); Stewart & Trinkle, Int. J. Numer. Meth. Engng 39 (1996).
#pragma once

#include <orthant/core/lcp/problem.h>

namespace orthant {

class Pyramid {  // reuse it: the second problem of a size allocates nothing
 public:
  enum class Form { shifted, stewart_trinkle };

  /// False when the problem has only [0, ∞) and free rows already.
  static bool needed(const Lcp& problem);

  /// The pure problem, dense; valid until the next call.
  const Lcp& pure(const Lcp& problem, Form form = Form::shifted);

  /// z of `problem` (the one last given to pure()) from a y of its pure form: within its bounds, to the bit, when the
  /// pure rows say so (at a bound z equals that bound exactly, ∓μ z_n included).
  void restore(const Lcp& problem, const Vector& y, Vector& z) const;

  /// The pure form's proof of infeasibility as one for `problem`: its u_i is 0 on boxes and friction rows.
  void restore_certificate(const Lcp& problem, const Vector& pure_u, Vector& u) const;

  /// y (without the added rows' values, which are only guessed as > 0 or 0) from a z of `problem`: a warm start.
  void guess(const Lcp& problem, const Vector& z, Vector& y) const;

 private:
  Lcp pure_;
  DenseMatrix dense_;
  Vector shift_;              // z = ±y + shift for one-sided and box rows
  std::vector<int> added_;    // per row: index of its first added row, or −1
  std::vector<int> kind_;     // per row: see pure_form.cpp
  std::vector<char> turned_;  // per row: a friction row whose sign was changed
  Form form_ = Form::shifted;
};

}  // namespace orthant
