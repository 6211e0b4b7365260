// solvers/linear_algebra/refined_basis.h — iterative refinement: z of a basis to full precision, approximate inverse.
//
//   Solve A_EU z_U = −(b_E + A_EK z_K), U the unknown and E the equation rows, K the rest, z_K given:
//     z_U ← z_U − B⁻¹ (A z + b)_E,   the residual and z in twice double precision.
//   A step multiplies the error by that of B⁻¹, about 1e-13: one or two do. z comes out correctly rounded, so that it
//   depends on the basis only, not on the path to it or on the order of rows.   O(n |U|) a step.
//   Source: Higham, Accuracy and Stability of Numerical Algorithms (2002), ch. 12.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <vector>

namespace orthant::detail {

class RefinedBasis {  // reuse it: the second basis of a size allocates nothing
 public:
  std::vector<Index> unknown, equation;  // U, E: of one length m

  /// Room for B⁻¹ ≈ A_EU⁻¹, m × m by columns (entry (i, j) belongs to unknown i and equation j).
  double* room() {
    inverse_.resize(static_cast<Index>(unknown.size() * unknown.size()));
    return inverse_.data();
  }

  /// z n: given on K, approximate on U on entry. A z_U below 2⁻⁸⁰ of the largest, in units of col, is a degenerate
  /// zero.
  void refine(const DenseMatrix& A, const Vector& b, const Vector& col, Vector& z);

 private:
  Vector inverse_, residual_, high_, low_;
};

}  // namespace orthant::detail
