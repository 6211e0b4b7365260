// core/lcp/judge/exact.h — exact arithmetic: rationals where rounding must not decide, with a fast filter.
//
//   Every double is a rational number, so signs, ranks and memberships of given data have exact answers. `Rational`
//   finds them, slowly. `Filtered` is a double with a bound on its error: its sign is certain or unknown, and an
//   unknown sign is computed again in rationals. Templates over both need sign(), weight(), quotient(),
//   subtract_product().
//   Cost: a Filtered operation some nanoseconds; a Rational one 0.1 µs for small integers, more as the numbers grow.
//   Source: Shewchuk, Discrete Comput. Geom. 18 (1997) (filters); GMP (numbers).
#pragma once

#include <orthant/core/lcp/problem.h>

#include <boost/multiprecision/gmp.hpp>

#include <cmath>
#include <functional>
#include <vector>

namespace orthant::exact {

using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;
using Row = std::vector<Rational>;
using Table = std::vector<Row>;

enum class Sign { negative = -1, zero = 0, positive = 1, unknown = 2 };

inline Sign sign(const Rational& x) { return static_cast<Sign>(x.sign() < 0 ? -1 : x.sign() > 0); }
inline double weight(const Rational& x) { return x.is_zero() ? 0 : 1; }  // preference as a pivot: any will do

/// The double nearest to x.
double nearest(const Rational& x);

struct Filtered {
  double value = 0, error = 0;  // the true number lies within value ± error
  Filtered() = default;
  Filtered(double exactly) : value(exactly) {}
  explicit Filtered(const Rational& x) : value(nearest(x)) {
    if (!std::isfinite(value))
      error = kInf;
    else if (Rational(value) != x)
      error = std::abs(value) * 0x1p-52 + 0x1p-1000;
  }
};

inline Sign sign(const Filtered& x) {
  if (x.value > x.error) return Sign::positive;
  if (-x.value > x.error) return Sign::negative;
  return x.value == 0 && x.error == 0 ? Sign::zero : Sign::unknown;  // NaN: unknown
}
inline Filtered operator-(Filtered x) {
  x.value = -x.value;
  return x;
}
inline double weight(const Filtered& x) { return std::abs(x.value) > x.error ? std::abs(x.value) : 0; }

/// a / b for a b whose sign is certain.
inline Rational quotient(const Rational& a, const Rational& b) { return a / b; }
inline Filtered quotient(const Filtered& a, const Filtered& b) {
  if (a.value == 0 && a.error == 0) return {};
  Filtered c(a.value / b.value);
  // |a'/b' − a/b| ≤ (e_a + |a/b| e_b) / (|b| − e_b), and a rounding; the last factor covers the roundings of the bound.
  c.error = ((a.error + std::abs(c.value) * b.error) / (std::abs(b.value) - b.error) + std::abs(c.value) * 0x1p-52) *
                (1 + 0x1p-40) +
            0x1p-1000;
  return c;
}

/// c ← c − a b.
inline void subtract_product(Rational& c, const Rational& a, const Rational& b) {
  if (!a.is_zero() && !b.is_zero()) c -= a * b;
}
inline void subtract_product(Filtered& c, const Filtered& a, const Filtered& b) {
  if ((a.value == 0 && a.error == 0) || (b.value == 0 && b.error == 0)) return;
  const double product = a.value * b.value;
  c.value -= product;
  c.error = (c.error + std::abs(a.value) * b.error + a.error * (std::abs(b.value) + b.error) +
             (std::abs(product) + std::abs(c.value)) * 0x1p-52) *
                (1 + 0x1p-40) +
            0x1p-1000;
}

/// c ← c + a b.
template <class T> void add_product(T& c, const T& a, const T& b) { subtract_product(c, T(-a), b); }

/// A as rationals, row by row; the Delassus operator is formed without rounding. Entries must be finite.
Table table(const Matrix& A);

/// Gauss–Jordan elimination within the first `columns` columns: rows are swapped and scaled so that row k has a 1 in
/// column pivots[k], the only nonzero of that column. Returns the pivots, ascending: as many as the rank.
std::vector<std::size_t> reduce(Table& rows, std::size_t columns);

/// Generators of the cone { x : G x ≥ 0 }: every member is Σ t_k rays[k] + Σ s_l lines[l], t ≥ 0. Rays are extreme when
/// there are no lines (else extreme in the part of the cone where the lines' free coordinates are 0).
/// Double description method; time and memory grow with the number of rays, which may be exponential. stop() is polled
/// for each ray and inequality: once it is true, what is returned has nothing in it.
/// Source: Fukuda & Prodon, Double description method revisited, LNCS 1120 (1996).
struct Cone {
  Table rays, lines;
};
Cone cone(const Table& G, std::size_t dimension, const std::function<bool()>& stop = {});

}  // namespace orthant::exact
