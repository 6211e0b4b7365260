// integrators/between_events/impact_series.h — impact accumulation (Zeno): impacts at ever shorter intervals.
//
//   Intervals Δ_n, ratio r = Δ_n / Δ_{n−1}. Two of them in a row < 0.999 (four impacts): a series, treated as a
//   geometric one. It ends Δ_n r / (1 − r) after the last impact.
#pragma once

#include <limits>

namespace orthant {

inline constexpr double kInTurn = 0.05;  // of their intervals: series so far apart have their impacts in turn

struct ImpactSeries {
  double last = -std::numeric_limits<double>::infinity();     // [s]
  double interval = std::numeric_limits<double>::infinity();  // [s]
  double ratio = 1;                                           // of the last two
  int shrinking = 0;                                          // intervals in a row
  double rest = 0;                                            // [s] what is left of the series

  void add(double t) {
    constexpr double kShrinking = 0.999;
    const double now = t - last;
    ratio = interval < std::numeric_limits<double>::infinity() ? now / interval : 1;
    shrinking = ratio < kShrinking ? shrinking + 1 : 0;
    rest = ratio < 1 ? now * ratio / (1 - ratio) : 0;
    interval = now, last = t;
  }
  bool accumulates() const { return shrinking >= 2; }
};

}  // namespace orthant
