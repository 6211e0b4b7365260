// solvers/active_set/small_active_set.h — undamped Newton on the minimum map: first attempt up to some hundred rows.
//
//   1. guess     two projected Gauss-Seidel sweeps from the start value; from 20 rows on, where they leave most rows
//                inside, and of Z-matrices always: all rows inside
//   2. choose    each row a side by its z_i and w_i: lower, upper, or inside (w_i = 0); a friction row at its bound has
//                z_t = ±μ z_n, which adds ±μ A_t to the column of z_n
//   3. solve     the inside rows by LU, those that depend on others left at 0 (redundant contacts); every row whose
//                sign is wrong changes sides; again. Where that gets nowhere and rows are few, the last of them alone,
//                as Murty's method does, which would end for every P-matrix
//   4. finish    when no sign is wrong: one step of refinement unless each w_i is at the rounding level of its own row
//   Mostly one to four factorizations where it works (P-matrices as they come, boxes, sticking and sliding contacts),
//   where pivoting takes a tableau update a row: 0.05 µs at one row, some at 20; at n = 80, cond 1e4, 5 times faster
//   than Lemke's tableau.
//   No guarantee: signs that stay wrong, or kMost factorizations (Z-matrices: kMostLayers) → false, and the caller
//   takes a method with a guarantee.
//   Dense storage.   O(n²) a sweep, m³/3 a factorization of m inside rows. For up to six rows, and for eight, it is
//   compiled for each number of rows by itself: loops without counters and nothing in the heap are worth a factor of
//   two there.
//   Source: Hintermüller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865-888; Kostreva, Lin. Algebra Appl. 21 (1978).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/budget.h>

#include <memory>

namespace orthant {

class SmallActiveSet {  // reuse it: the second problem of a size allocates nothing
 public:
  static constexpr double kMostly = 0.7;

  SmallActiveSet();
  ~SmallActiveSet();

  /// True when z solves the problem to the rounding of each row (which the judge may still see otherwise); z is the
  /// start value on entry, n finite numbers. `iterations` counts factorizations; the budget is polled before each later
  /// one.
  /// `mostly`: the share of rows that counts as most.
  bool solve(const Lcp& problem, Vector& z, int& iterations, const Budget& budget = {}, double mostly = kMostly);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace orthant
