#include <orthant/core/support/every_width.h>
#include <orthant/integrators/derivatives/slope_blocks.h>

namespace orthant {

namespace {

template <int w> struct Wide { using Type [[gnu::vector_size(8 * w), gnu::aligned(8), gnu::may_alias]] = double; };
template <> struct Wide<1> { using Type = double; };

/// f.operator()<w>(first column) for w columns at a time, w = 8, then 4, 2, 1.
template <class F> [[gnu::always_inline]] inline void by_widths(Eigen::Index count, F&& f) {
  Eigen::Index first = 0;
  for (; count - first >= 8; first += 8) f.template operator()<8>(first);
  if ((count & 4) != 0) f.template operator()<4>(first), first += 4;
  if ((count & 2) != 0) f.template operator()<2>(first), first += 2;
  if ((count & 1) != 0) f.template operator()<1>(first);
}

template <int w> [[gnu::always_inline]] inline typename Wide<w>::Type& at(double* x) {
  return *reinterpret_cast<typename Wide<w>::Type*>(x);
}
template <int w> [[gnu::always_inline]] inline const typename Wide<w>::Type& at(const double* x) {
  return *reinterpret_cast<const typename Wide<w>::Type*>(x);
}

}  // namespace

ORTHANT_EVERY_WIDTH void apply_to_block(std::span<const Slope> slopes, const double* x, double* y, Eigen::Index count) {
  by_widths(
      count, [&]<int w>(Eigen::Index first) __attribute__((always_inline)) {
        for (const Slope& s : slopes) at<w>(y + s.of * count + first) += s.value * at<w>(x + s.by * count + first);
      });
}

ORTHANT_EVERY_WIDTH void solve_block(const double* LU, const Eigen::Index* row, Eigen::Index n, const double* b,
                                     double* x, Eigen::Index count) {
  by_widths(
      count, [&]<int w>(Eigen::Index first) __attribute__((always_inline)) {
        for (Eigen::Index i = 0; i < n; ++i) {
          typename Wide<w>::Type sum = at<w>(b + row[i] * count + first);
          for (Eigen::Index j = 0; j < i; ++j) sum -= LU[i * n + j] * at<w>(x + j * count + first);
          at<w>(x + i * count + first) = sum;
        }
        for (Eigen::Index i = n - 1; i >= 0; --i) {
          typename Wide<w>::Type sum = at<w>(x + i * count + first);
          for (Eigen::Index j = i + 1; j < n; ++j) sum -= LU[i * n + j] * at<w>(x + j * count + first);
          at<w>(x + i * count + first) = sum * LU[i * n + i];
        }
      });
}

}  // namespace orthant
