// core/support/simd2.h — SIMD pair: two doubles in one 16-byte register.
//
// It is built from scalars in registers, unlike Eigen's Array2d: a processor waits if it reads as a whole what was just
// stored number by number.
#pragma once

#include <cstring>

namespace orthant {

struct Simd2 {
  using Lanes [[gnu::vector_size(16)]] = double;
  Lanes lanes;

  Simd2() = default;
  Simd2(double both) : lanes{both, both} {}
  Simd2(double first, double second) : lanes{first, second} {}
  static Simd2 load(const double* from) {
    Simd2 two;
    std::memcpy(&two.lanes, from, sizeof two.lanes);
    return two;
  }
  void store(double* to) const { std::memcpy(to, &lanes, sizeof lanes); }

  double operator[](int i) const { return lanes[i]; }
  double sum() const { return lanes[0] + lanes[1]; }
  Simd2& operator+=(Simd2 b) { return lanes += b.lanes, *this; }
  Simd2& operator-=(Simd2 b) { return lanes -= b.lanes, *this; }
  Simd2& operator*=(Simd2 b) { return lanes *= b.lanes, *this; }
  friend Simd2 operator+(Simd2 a, Simd2 b) { return a += b; }
  friend Simd2 operator-(Simd2 a, Simd2 b) { return a -= b; }
  friend Simd2 operator*(Simd2 a, Simd2 b) { return a *= b; }
};

}  // namespace orthant
