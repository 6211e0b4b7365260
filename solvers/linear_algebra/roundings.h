// solvers/linear_algebra/roundings.h — rounding thresholds of a scalar type, and the row operation that applies them.
#pragma once

#include <orthant/solvers/linear_algebra/kernels.h>

#include <cmath>
#include <type_traits>

namespace orthant::detail {

/// snap: cancelled to noise; tie: equal at worst; pivot: too small in its column.
template <class T> struct Roundings;  // scalars.h has the types beyond these
template <> struct Roundings<double> {
  static constexpr double unit = 0x1p-53, snap = 0x1p-46, tie = 0x1p-36, pivot = 0x1p-36;
};
template <> struct Roundings<long double> {
  static constexpr long double unit = 0x1p-64L, snap = 0x1p-57L, tie = 0x1p-47L, pivot = 0x1p-47L;
};

template <class T> T magnitude(T x) {
  if constexpr (std::is_floating_point_v<T>) return std::abs(x);  // one instruction, and vectors of them
  return x < 0 ? -x : x;
}

/// line ← line + f p; entries that cancel to noise become 0.
template <class T> void add_multiple(T* __restrict line, const T f, const T* __restrict p, int size) {
  if constexpr (std::is_same_v<T, double>) {
    add_multiple(line, f, p, Index{size}, Roundings<double>::snap);
  } else {
    for (int c = 0; c < size; ++c) {
      if constexpr (std::is_floating_point_v<T>) {
        const T x = line[c], y = x + f * p[c];
        line[c] = magnitude(y) <= Roundings<T>::snap * magnitude(x) ? T(0) : y;
      } else if (p[c] != 0) {  // a product costs more than the question, and noise lies far below the smallest pivot
        line[c] += f * p[c];
      }
    }
  }
}

}  // namespace orthant::detail
