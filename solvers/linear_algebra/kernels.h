// solvers/linear_algebra/kernels.h — kernels of dense elimination: loops over whole rows and columns.
//
//   Compiled for several instruction sets; the widest that the machine has is chosen when the program starts. Each
//   entry is computed by itself, in the order written and without fused operations, so that the width never changes a
//   bit.
//   Comparison with the portable instruction set (2 numbers at a time): experiments/benchmarks/README.md.
#pragma once

#include <Eigen/Core>

namespace orthant::detail {

using Index = Eigen::Index;

/// x ← x + f p; a sum that cancels to `snap` times what it was becomes 0.
void add_multiple(double* x, double f, const double* p, Index size, double snap);

/// x ← (x + f₀ p₀) + f₁ p₁ + … of `count` terms; a sum that ends at `snap` times the largest it was on the way, or
/// below, becomes 0.
void add_multiples(double* x, const double* f, const double* const* p, int count, Index size, double snap);

/// The same for four rows at once, which share the p_q, bit for bit: row r has the factors f[4 q + r]. `reach`: of each
/// row Σ_q |f_q| max_i |p_q,i|.
void add_multiples_to_four(double* const* x, const double* f, const double* const* p, int count, Index size,
                           double snap, const double* reach);

/// x ← ((((x − f₀ c₀) − f₁ c₁) − f₂ c₂) − f₃ c₃), the columns c_k `stride` numbers apart.
void subtract_four(double* x, const double* f, const double* columns, Index stride, Index size);

/// x ← x − f c.
void subtract(double* x, double f, const double* column, Index size);

/// w ← w + f c, size ← size + |f c|: a product and its rounding, column by column.
void add_with_size(double* w, double* size, double f, const double* column, Index n);

/// max |x_i|; 0 of none, and NaN are passed over.
double largest(const double* x, Index size);

}  // namespace orthant::detail
