// core/support/spline.h — clamped cubic spline through given points.
//   Between neighbours a cubic; value, slope and curvature are continuous. Slope 0 at both ends, constant outside.
//   The slopes m solve m_{i−1}/h_{i−1} + 2 (1/h_{i−1} + 1/h_i) m_i + m_{i+1}/h_i = 3 (Δ_{i−1}/h_{i−1} + Δ_i/h_i),
//   Δ_i = (y_{i+1} − y_i)/h_i, h_i = t_{i+1} − t_i: tridiagonal, diagonally dominant, O(n) once. A call: O(log n).
//   The curvature jumps where the constant parts begin.
// Source: de Boor, A Practical Guide to Splines (1978), ch. IV.
#pragma once

#include <vector>

namespace orthant {

class Spline {
 public:
  Spline() = default;  // zero everywhere
  /// times ascending, as many as values, at least one, all finite, and so are the slopes and curvatures between.
  /// Throws std::invalid_argument naming which and the rule.
  Spline(std::vector<double> times, std::vector<double> values);

  const std::vector<double>& times() const { return t_; }
  double value(double t) const { return at(t, 0); }
  double rate(double t) const { return at(t, 1); }
  double acceleration(double t) const { return at(t, 2); }

 private:
  double at(double t, int derivative) const;

  std::vector<double> t_, y_, slope_;
};

}  // namespace orthant
