// solvers/even_share.h — canonical solution: contact impulses that the problem leaves open, shared evenly.
//
//   Rows that depend on each other leave z open: normals (a box on four corners), and tangents (three feet that stick
//   may pull against each other). Where contacts slide shares matter: with a yaw friction's moment depends on them.
//   Which solution a method finds depends on the order of rows and on rounding. Here it is the limit of proximal steps
//   from none, as of contacts with a little compliance:
//     z⁰ = 0,   z^{k+1} solves   w = A z + b + D (z − z^k),   D_ii = 10⁻³ A_ii, of a disc's rows their mean.
//   Each step has one solution where friction does not dominate; the limit solves the problem itself. Mirrored, turned
//   or reordered problems have mirrored, turned or reordered answers.
//   Where all rows are independent, or more than 300, nothing is done. No limit within 50 steps: z stays as it is.
//   Cost: a few solves of the problem's size.
// Source: Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898 (proximal points).
#pragma once

#include <orthant/solvers/refinement.h>

#include <Eigen/Dense>

namespace orthant {

class EvenShare {  // reuse it: the members are scratch
 public:
  /// Replaces z, w and residual of a solved s of a dense problem. normals: the rows that share loads come first, so
  /// many. True: it did.
  bool improve(const Lcp& problem, Index normals, Solver& solver, Solution& s);

  /// Whether w depends on the shares in the s improved last: contacts slide, each its own way, and none sticks.
  bool matters(const Lcp& problem, const Solution& s) const;

 private:
  bool open(const Lcp& problem);

  Index normals_ = 0;
  Lcp step_;
  Refinement refinement_;
  Solution trial_, found_;
  Vector weight_, last_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> rank_;
  Judge judge_;
};

}  // namespace orthant
