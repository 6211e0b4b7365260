// core/lcp/judge/dixon_lifting.h — Dixon's p-adic lifting: integer linear systems solved exactly.
//
//   Arithmetic modulo the prime p = 2³¹ − 1 finds which rows and columns of a table are independent, and the inverse
//   C of a regular matrix M. Then M x = r, digit by digit:
//     d_k = C r_k mod p,   r_{k+1} = (r_k − M d_k) / p,   x = Σ_k d_k p^k  modulo p^{k+1}.                         (1)
//   The rational x follows by Euclid's algorithm, stopped half way. M x = r is checked in integers, so that a prime
//   that divides a minor costs an answer, never its truth.
//   Cost: O(n³) once, O(n²) for each 31 binary digits of x.
//   Source: Dixon, Numer. Math. 40 (1982).
#pragma once

#include <boost/multiprecision/gmp.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace orthant::exact {

using Integer = boost::multiprecision::number<boost::multiprecision::gmp_int, boost::multiprecision::et_off>;
using IntegerTable = std::vector<std::vector<Integer>>;  // by rows

struct ModularPivots {
  std::vector<std::size_t> rows, columns;  // of equal length
};
/// A largest regular block of A modulo p, the first columns preferred. stop() is polled. Empty: A is zero, stop() said
/// true, or the work is above its limit of some seconds.
ModularPivots find_pivots(const IntegerTable& A, std::size_t columns, const std::function<bool()>& stop = {});

struct Ratios {
  std::vector<Integer> numerators;
  Integer denominator = 1;
};
/// The x with M x = right. None: M is singular modulo p, stop() said true, or the work is above its limit.
std::optional<Ratios> solve_exactly(const IntegerTable& M, const std::vector<Integer>& right,
                                    const std::function<bool()>& stop = {});

}  // namespace orthant::exact
