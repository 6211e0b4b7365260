// solvers/linear_algebra/scalars.h — scalar types of higher precision, with their roundings (roundings.h).
//
//   Friction at mass ratios of 1e10: the Delassus matrix has as many tiny singular values as contacts beyond the
//   freedoms and a pivot path divides by one after the other, so that quadruple precision loses every digit at n = 80.
//   256 bits do not, at some 60 times the cost of double. Rationals have no rounding: for small problems the path is
//   exact.
#pragma once

#include <orthant/core/lcp/judge/exact.h>
#include <orthant/solvers/linear_algebra/roundings.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

namespace orthant::detail {

namespace mp = boost::multiprecision;
using Float256 = mp::number<mp::cpp_bin_float<256, mp::digit_base_2>, mp::et_off>;
using exact::Rational;

template <> struct Roundings<Float256> {
  inline static const Float256 unit = ldexp(Float256(1), -256), snap = ldexp(Float256(1), -249),
                               tie = ldexp(Float256(1), -192), pivot = ldexp(Float256(1), -192);
};
template <> struct Roundings<Rational> {  // nothing cancels to noise, nothing is equal but what is
  static constexpr int unit = 0, snap = 0, tie = 0, pivot = 0;
};

}  // namespace orthant::detail
