// integrators/between_events/first_crossing.h — event location: finds where an event function first turns negative in a
// step.
//
//   A polynomial on [0, 1] in Bernstein form Σ c_i (n choose i) x^i (1−x)^(n−i) lies within the hull of its
//   coefficients. Without a coefficient below −slack there is no crossing, so no pair of crossings is overlooked.
//   Otherwise the interval is halved (de Casteljau), and the left half is searched first. O(n²) per halving.
//   quintic: value, rate and second derivative at both ends; cubic: value and rate; quartic: five values.
//   Source: Farin, Curves and Surfaces for CAGD (2002), ch. 5.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

namespace orthant {

template <std::size_t N> using Bernstein = std::array<double, N>;  // degree N − 1

/// Of values f, rates f' and f'' [1/s, 1/s²] at the ends of a step of length h [s].
inline Bernstein<6> quintic(double f0, double d0, double dd0, double f1, double d1, double dd1, double h) {
  return {
      f0, f0 + h * d0 / 5, f0 + h * (2 * d0 / 5 + h * dd0 / 20), f1 - h * (2 * d1 / 5 - h * dd1 / 20), f1 - h * d1 / 5,
      f1};
}
inline Bernstein<4> cubic(double f0, double d0, double f1, double d1, double h) {
  return {f0, f0 + h * d0 / 3, f1 - h * d1 / 3, f1};
}
/// Of its values at 0, 1/4, 1/2, 3/4, 1.
inline Bernstein<5> quartic(const std::array<double, 5>& f) {
  return {f[0], (-13 * f[0] + 48 * f[1] - 36 * f[2] + 16 * f[3] - 3 * f[4]) / 12,
          (13 * f[0] - 64 * f[1] + 120 * f[2] - 64 * f[3] + 13 * f[4]) / 18,
          (-3 * f[0] + 16 * f[1] - 36 * f[2] + 48 * f[3] - 13 * f[4]) / 12, f[4]};
}

struct Crossing {
  double x = 0, slope = 0;  // slope: mean rate just there, < 0
};

/// The first x where the polynomial falls below −slack.
template <std::size_t N>
std::optional<Crossing> first_crossing(Bernstein<N> c, double slack, double low = 0, double high = 1) {
  if (std::all_of(c.begin(), c.end(), [&](double value) { return value >= -slack; })) return {};
  if (high - low <= 1e-13 * high || high < 1e-30) {
    if (c.back() >= -slack) return {};
    return Crossing{low, (c.back() - c.front()) / (high - low)};
  }
  Bernstein<N> left;
  for (std::size_t i = 0; i < N; ++i) {
    left[i] = c[0];
    for (std::size_t j = 0; j + 1 + i < N; ++j) c[j] = (c[j] + c[j + 1]) / 2;
  }
  const double middle = (low + high) / 2;  // c is the right half now
  if (const auto found = first_crossing(left, slack, low, middle)) return found;
  return first_crossing(c, slack, middle, high);
}

}  // namespace orthant
