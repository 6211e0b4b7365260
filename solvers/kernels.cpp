#include <orthant/solvers/kernels.h>

#include <cmath>

// Where the linker resolves a function by the machine (GNU indirect functions), which sanitizers do not survive.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define ORTHANT_EVERY_WIDTH __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ORTHANT_EVERY_WIDTH
#endif

namespace orthant::detail {

ORTHANT_EVERY_WIDTH void add_multiple(double* __restrict x, double f, const double* __restrict p, Index size,
                                      double snap) {
  for (Index i = 0; i < size; ++i) {
    const double before = x[i], after = before + f * p[i];
    x[i] = std::abs(after) <= snap * std::abs(before) ? 0.0 : after;
  }
}

ORTHANT_EVERY_WIDTH void subtract_four(double* __restrict x, const double* __restrict f,
                                       const double* __restrict columns, Index stride, Index size) {
  const double f0 = f[0], f1 = f[1], f2 = f[2], f3 = f[3];
  const double *const c0 = columns, *const c1 = c0 + stride, *const c2 = c1 + stride, *const c3 = c2 + stride;
  for (Index i = 0; i < size; ++i) x[i] = (((x[i] - f0 * c0[i]) - f1 * c1[i]) - f2 * c2[i]) - f3 * c3[i];
}

ORTHANT_EVERY_WIDTH void subtract(double* __restrict x, double f, const double* __restrict column, Index size) {
  for (Index i = 0; i < size; ++i) x[i] -= f * column[i];
}

ORTHANT_EVERY_WIDTH void add_with_size(double* __restrict w, double* __restrict size, double f,
                                       const double* __restrict column, Index n) {
  for (Index i = 0; i < n; ++i) {
    const double term = f * column[i];
    w[i] += term;
    size[i] += std::abs(term);
  }
}

ORTHANT_EVERY_WIDTH double largest(const double* x, Index size) {
  double most[8] = {};  // so that none waits for the last
  Index i = 0;
  for (; i + 8 <= size; i += 8)
    for (Index k = 0; k < 8; ++k) most[k] = most[k] < std::abs(x[i + k]) ? std::abs(x[i + k]) : most[k];
  for (; i < size; ++i) most[0] = most[0] < std::abs(x[i]) ? std::abs(x[i]) : most[0];
  for (int k = 1; k < 8; ++k) most[0] = most[0] < most[k] ? most[k] : most[0];
  return most[0];
}

}  // namespace orthant::detail
