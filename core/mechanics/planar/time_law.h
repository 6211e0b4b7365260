// core/mechanics/planar/time_law.h — time law: a coordinate given in time, with its first two derivatives.
//   s(t) = offset + rate t + amplitude sin(omega t + phase) + table(t)   [rad or m], t in s.
#pragma once

#include <orthant/core/support/spline.h>

#include <cmath>

namespace orthant {

struct TimeLaw {
  double offset = 0, rate_of_change = 0;       // [rad or m], [.../s]
  double amplitude = 0, omega = 0, phase = 0;  // [rad or m], [rad/s], [rad]
  Spline table;                                // empty: none

  double value(double t) const {
    return offset + rate_of_change * t + amplitude * std::sin(omega * t + phase) + table.value(t);
  }
  double rate(double t) const {
    return rate_of_change + amplitude * omega * std::cos(omega * t + phase) + table.rate(t);
  }
  /// What rate(t) is summed of: it is rounded as a number of that size is.
  double size_of_rate(double t) const {
    return std::abs(rate_of_change) + std::abs(amplitude * omega) * (1 + std::abs(omega * t + phase)) +
           std::abs(table.rate(t));
  }
  double acceleration(double t) const {
    return -amplitude * omega * omega * std::sin(omega * t + phase) + table.acceleration(t);
  }
};

}  // namespace orthant
