#include <orthant/core/support/every_width.h>
#include <orthant/solvers/linear_algebra/kernels.h>

#include <cmath>

namespace orthant::detail {

ORTHANT_EVERY_WIDTH void add_multiple(double* __restrict x, double f, const double* __restrict p, Index size,
                                      double snap) {
  for (Index i = 0; i < size; ++i) {
    const double before = x[i], after = before + f * p[i];
    x[i] = std::abs(after) <= snap * std::abs(before) ? 0.0 : after;
  }
}

namespace {

// Four numbers: a register of AVX2. Of eight, GCC 12 stores halves and entries apart where registers are shorter, and
// reads them as a whole: ten times as long for a tableau of 100 rows.
constexpr Index kLanes = 4;
using Four [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
using Bits [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = long long;

/// Entries from … to − 1, one by one.
void add_multiples_plainly(double* x, const double* f, int stride, const double* const* p, int count, Index from,
                           Index to, double snap) {
  for (Index i = from; i < to; ++i) {
    double sum = x[i], most = std::abs(sum);
    for (int q = 0; q < count; ++q) {
      sum += f[q * stride] * p[q][i];
      most = most > std::abs(sum) ? most : std::abs(sum);
    }
    x[i] = std::abs(sum) <= snap * most ? 0.0 : sum;
  }
}

}  // namespace

ORTHANT_EVERY_WIDTH void add_multiples(double* x, const double* f, const double* const* p, int count, Index size,
                                       double snap) {
  const Bits magnitude = Bits{} + 0x7fffffffffffffff;  // all but the signs
  constexpr Index kWide = 2;                           // so that one sum need not wait for the other
  Index i = 0;
  for (; i + kLanes * kWide <= size; i += kLanes * kWide) {
    Four sum[kWide], most[kWide];
    for (Index k = 0; k < kWide; ++k) {
      sum[k] = *reinterpret_cast<const Four*>(x + i + kLanes * k);
      most[k] = reinterpret_cast<Four>(reinterpret_cast<Bits>(sum[k]) & magnitude);
    }
    for (int q = 0; q < count; ++q)
      for (Index k = 0; k < kWide; ++k) {
        sum[k] += f[q] * *reinterpret_cast<const Four*>(p[q] + i + kLanes * k);
        const Four now = reinterpret_cast<Four>(reinterpret_cast<Bits>(sum[k]) & magnitude);
        most[k] = most[k] > now ? most[k] : now;
      }
    for (Index k = 0; k < kWide; ++k)
      *reinterpret_cast<Four*>(x + i + kLanes * k) =
          reinterpret_cast<Four>(reinterpret_cast<Bits>(sum[k]) & magnitude) <= snap * most[k] ? Four{} : sum[k];
  }
  add_multiples_plainly(x, f, 1, p, count, i, size, snap);
}

// To watch how large a sum is on its way costs as much as to add. So the sums are looked at only where their end is
// small relative to their largest possible values.
ORTHANT_EVERY_WIDTH void add_multiples_to_four(double* const* x, const double* f, const double* const* p, int count,
                                               Index size, double snap, const double* reach) {
  const Bits magnitude = Bits{} + 0x7fffffffffffffff;
  constexpr int kRows = 4;
  constexpr Index kWide = 2;
  Index i = 0;
  for (; i + kLanes * kWide <= size; i += kLanes * kWide) {
    Four sum[kRows][kWide];
    for (int r = 0; r < kRows; ++r)
      for (Index k = 0; k < kWide; ++k) sum[r][k] = *reinterpret_cast<const Four*>(x[r] + i + kLanes * k);
    for (int q = 0; q < count; ++q)
      for (Index k = 0; k < kWide; ++k) {
        const Four term = *reinterpret_cast<const Four*>(p[q] + i + kLanes * k);
        for (int r = 0; r < kRows; ++r) sum[r][k] += f[kRows * q + r] * term;
      }
    Bits small = {};
    for (int r = 0; r < kRows; ++r)
      for (Index k = 0; k < kWide; ++k) {
        const Four before = *reinterpret_cast<const Four*>(x[r] + i + kLanes * k);
        const Four most = reinterpret_cast<Four>(reinterpret_cast<Bits>(before) & magnitude) + reach[r];
        small |= (reinterpret_cast<Four>(reinterpret_cast<Bits>(sum[r][k]) & magnitude) <= 2 * snap * most) &
                 (sum[r][k] != 0);
      }
    long long any = 0;
    for (int lane = 0; lane < kLanes; ++lane) any |= small[lane];
    for (int r = 0; r < kRows; ++r) {
      if (any != 0) add_multiples_plainly(x[r], f + r, kRows, p, count, i, i + kLanes * kWide, snap);
      for (Index k = 0; k < kWide && any == 0; ++k) *reinterpret_cast<Four*>(x[r] + i + kLanes * k) = sum[r][k];
    }
  }
  for (int r = 0; r < kRows; ++r) add_multiples_plainly(x[r], f + r, kRows, p, count, i, size, snap);
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
