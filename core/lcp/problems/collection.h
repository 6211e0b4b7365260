// core/lcp/problems/collection.h — named problems with known answers, and random problems from a seed.
//
//   Shared by tests and benchmarks. Answers are exact: rational numbers worked out by hand, or planted (q = w* − M z*
//   in numbers that double holds exactly). A name states the source of a problem; the comments in collection.cpp state
//   the difficulty.
#pragma once

#include <orthant/core/lcp/solution.h>
#include <orthant/core/support/random.h>

#include <cstdint>
#include <string>
#include <vector>

namespace orthant {

enum class Answer {
  unique,      // z is the only solution
  one_of,      // z is one of several
  infeasible,  // no z has the signs of w that the rows demand: a proof exists
  none,        // no solution, and no such proof either
};

struct Known {
  std::string name;
  Lcp problem;
  Answer answer = Answer::unique;
  Vector z;               // empty when there is none
  double accuracy = 0;    // ‖error‖∞ / ‖z‖∞ that the conditioning allows; 0: rounding of z itself
  bool unique_w = false;  // several z, but all with the same w
};

/// All of them, n ≤ 60, dense. Built again at each call.
std::vector<Known> known_problems();

/// M with 1 on the diagonal and 2 below, q = −e: z = e₁. Lemke's method takes 2ⁿ pivots (Murty 1978); on the
/// transposed (z = eₙ) 2, where pivoting by the least index takes 2ⁿ − 1; on M Mᵀ (Fathi 1979, z = e₁) 2ⁿ again.
Lcp murty_problem(Index n, bool transposed = false);

/// The same problem with A stored as rows.
Lcp as_sparse(const Lcp& problem);

/// Any signs, any solvability; entries are integers in [−2, 2], so that ties and singular blocks abound. Rows of the
/// requested kinds alternate at random.
struct Kinds {
  bool free = false, box = false, friction = false;
};
Lcp random_integer_problem(Index n, Kinds kinds, Random& random);

/// M = BᵀB + S, S skew, B rank × n: monotone, solvable, z and w known: `strict` rows have one of z_i, w_i positive, the
/// other n − strict have both zero. Small integers: q is exact.
Known planted_problem(Index n, Index rank, Index strict, Random& random);

/// BᵀB + I with normal numbers in B, q normal: symmetric positive definite.
Lcp random_spd_problem(Index n, Random& random);

/// tridiagonal(−1, 4, −1) and one or two entries in (−1, 1) a row, anywhere in it, q normal: strictly diagonally
/// dominant and unsymmetric; the factors of large ones fill in.
Lcp random_sparse_problem(Index n, Random& random);

/// `contacts` planar contacts of bodies with normal entries in W, as a Delassus operator, friction coefficient mu:
/// rows N₁ T₁ N₂ T₂ …, dof coordinates with masses in [0.5, 2].
Lcp random_contact_problem(Index contacts, Index dof, double mu, Random& random);

/// Planar frictional contacts in the copositive form of Stewart and Trinkle, dense, n = 4 contacts, as many freedoms as
/// contacts: J_N, J_T and v normal, D = [J_T; −J_T], inverse masses log-uniform in [1/mass_ratio, 1], and
///   M = [ J M⁻¹ Jᵀ  (0; E) ; (μ −Eᵀ)  0 ],  J = [J_N; D], E = [I; I],   q = (J_N v; D v; 0),   z = (λ_N; λ_T; γ).
/// Solvable by theory; harder with each power of ten of the mass ratio.
/// Source: Stewart & Trinkle, Int. J. Numer. Meth. Engng 39 (1996) 2673-2691.
Lcp stewart_trinkle_problem(Index contacts, double mu, double mass_ratio, Random& random);

}  // namespace orthant
