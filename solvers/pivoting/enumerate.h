// solvers/pivoting/enumerate.h — enumeration of all solutions, exact: the oracle of the tests.
//
//   A solution chooses for each row one of
//     lower   z_i = lo_i, w_i ≥ 0        inside   w_i = 0, lo_i ≤ z_i ≤ hi_i        upper   z_i = hi_i, w_i ≤ 0
//   (friction rows: ∓μ z_n for the bounds; free rows: inside only; rows with lo_i = hi_i: z_i = lo_i, w_i of any sign).
//   Each choice gives a polyhedron, mostly empty or a point; the solution set is their union. The choices are
//   the leaves of a tree, visited depth first. At a node z is an affine function of some of its entries, and so are
//   all bounds and signs to be met; each level adds one equation, which takes one entry away: O(n p) work for p entries
//   left, so that the leaves, where p ≈ 0, cost almost nothing.  All together about n 2ⁿ operations, less what is cut:
//     – a form that should be ≥ 0, but has no positive coefficient and a negative constant, ends the branch,
//     – inside with z_i fixed at its bound is part of lower (upper), and not visited; where w_i = 0 throughout, lower
//     and
//       upper are parts of inside, and it alone is.
//   Arithmetic is double with error bounds (exact.h); a sign that it leaves open, and every solution found, is done
//   again in rationals: the result is the exact answer for the numbers given, the Delassus operator being formed
//   exactly.
//   A polyhedron with entries left is described by its vertices and directions (double description, exact.h). One
//   that lies in another is dropped: exactly when each form that it lets be ≠ 0 somewhere is ≠ 0 somewhere in the
//   other.
//
//   As a solver: the first vertex of a polyhedron, in binary counting order (bit i = row i, lower first), that the
//   judge accepts. No solution → infeasible: the classes of cells that were cut, each with its reason, are the proof
//   (judge/cells.h), up to 100 000 classes. A solution that no double can hold → stalled.
//   Rationals allocate: unlike the other solvers, this one does so in every solve.
//   At most 2²⁰ choices: 20 rows [0, ∞), or 12 boxes or friction rows; at most 100 rows. A start value is not used.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 1.1, 1.4 (complementary cones).
#pragma once

#include <orthant/solvers/solver.h>

#include <functional>
#include <string>
#include <vector>

namespace orthant {

/// The convex hull of the vertices, plus nonnegative multiples of the directions, plus any multiples of the lines.
/// Directions and lines are scaled to a largest entry of ±1. With lines, `vertices` are points, one for each vertex
/// of the face cut across the lines.
struct SolutionFace {
  Index dimension = 0;
  std::vector<Vector> vertices, directions, lines;  // of n entries each, exact results rounded once
};

/// All solutions: isolated points, and maximal faces of dimension ≥ 1 (each the solutions of one choice; faces may meet
/// and together be convex). Both in the order in which they are found.
struct SolutionSet {
  std::vector<Vector> isolated;
  std::vector<SolutionFace> faces;
  bool complete =
      true;  // false: stopped; these are solutions, but there may be more, and faces may be parts of larger ones
};

/// `stop` is polled; it ends the search where it says true.
/// Throws std::invalid_argument when the problem is malformed, not finite or too large.
SolutionSet enumerate_solutions(const Lcp& problem, const std::function<bool()>& stop = {});

struct EnumerateOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  template <class V> void visit(V&& v) { v("tolerance", tolerance, 0.0, 1.0); }
};

class Enumerate final : public Solver {
 public:
  using Options = EnumerateOptions;
  explicit Enumerate(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 1e-12; }  // a right basis, refined, is at rounding level

  Options options_;
  Judge candidate_judge_;
};

}  // namespace orthant
