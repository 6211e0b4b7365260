#include "experiments/studies/exact_cases/reference_motion.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace orthant {
namespace {

constexpr int kColumns = 8;

/// Modified midpoint rule over h in n parts.
RealVector midpoint(const std::function<RealVector(const RealVector&)>& f, const RealVector& y, Real h, int n) {
  const Real s = h / n;
  RealVector before = y, now = y + s * f(y);
  for (int k = 1; k < n; ++k) {
    const RealVector next = before + 2 * s * f(now);
    before = now, now = next;
  }
  return (before + now + s * f(now)) / 2;
}

struct GaussRule {
  static constexpr int kPoints = 20;
  std::array<Real, kPoints> x{}, weight{};
  /// Roots of Legendre's polynomial by Newton's method.
  GaussRule() {
    for (std::size_t i = 0; i < kPoints; ++i) {
      Real z = std::cos(std::numbers::pi_v<Real> * (static_cast<Real>(i) + 0.75L) / (kPoints + 0.5L)), slope = 0;
      for (int step = 0; step < 20; ++step) {
        Real p = 1, last = 0;
        for (int n = 1; n <= kPoints; ++n) {
          const Real next = ((2 * n - 1) * z * p - (n - 1) * last) / n;
          last = p, p = next;
        }
        slope = kPoints * (z * p - last) / (z * z - 1);
        z -= p / slope;
      }
      x[i] = z, weight[i] = 2 / ((1 - z * z) * slope * slope);
    }
  }
};

}  // namespace

RealVector extrapolate(const std::function<RealVector(const RealVector&)>& f, RealVector y, Real duration, int steps) {
  const Real h = duration / steps;
  std::vector<RealVector> table(kColumns);
  for (int step = 0; step < steps; ++step) {
    for (int row = 0; row < kColumns; ++row) {
      RealVector best = midpoint(f, y, h, 2 * (row + 1));
      for (int column = 0; column < row; ++column) {  // table[k]: the last row's entry of column k
        const Real ratio = static_cast<Real>(row + 1) / static_cast<Real>(row - column);
        const RealVector better = best + (best - table[static_cast<std::size_t>(column)]) / (ratio * ratio - 1);
        table[static_cast<std::size_t>(column)] = best, best = better;
      }
      table[static_cast<std::size_t>(row)] = best;
    }
    y = table.back();
  }
  return y;
}

Real integrate(const std::function<Real(Real)>& f, Real a, Real b, int panels) {
  static const GaussRule rule;
  const Real width = (b - a) / panels;
  Real sum = 0;
  for (int k = 0; k < panels; ++k)
    for (std::size_t i = 0; i < GaussRule::kPoints; ++i)
      sum += rule.weight[i] * f(a + width * (static_cast<Real>(k) + (1 + rule.x[i]) / 2));
  return sum * width / 2;
}

Real angle_after(const std::function<Real(Real)>& rate, Real from, Real t) {
  constexpr int kPanels = 16, kSteps = 50;
  Real angle = from + t * rate(from);
  for (int step = 0; step < kSteps; ++step) {
    const Real late = integrate([&](Real at) { return 1 / rate(at); }, from, angle, kPanels) - t;
    angle -= late * rate(angle);
    if (std::abs(late) < 1e-18L) break;
  }
  return angle;
}

}  // namespace orthant
