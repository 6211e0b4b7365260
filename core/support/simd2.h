// core/support/simd2.h — SIMD pair: two doubles in one 16-byte register.
//
// Put together from scalars in registers, as Eigen's Array2d is not: memory that was just stored number by number and
// is read as a whole makes a processor wait.
#pragma once

#include <cstring>

namespace orthant {

struct Two {
  using Lanes [[gnu::vector_size(16)]] = double;
  Lanes lanes;

  Two() = default;
  Two(double both) : lanes{both, both} {}
  Two(double first, double second) : lanes{first, second} {}
  static Two load(const double* from) {
    Two two;
    std::memcpy(&two.lanes, from, sizeof two.lanes);
    return two;
  }
  void store(double* to) const { std::memcpy(to, &lanes, sizeof lanes); }

  double operator[](int i) const { return lanes[i]; }
  double sum() const { return lanes[0] + lanes[1]; }
  Two& operator+=(Two b) { return lanes += b.lanes, *this; }
  Two& operator-=(Two b) { return lanes -= b.lanes, *this; }
  Two& operator*=(Two b) { return lanes *= b.lanes, *this; }
  friend Two operator+(Two a, Two b) { return a += b; }
  friend Two operator-(Two a, Two b) { return a -= b; }
  friend Two operator*(Two a, Two b) { return a *= b; }
};

}  // namespace orthant
