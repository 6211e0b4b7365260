// core/scenes/slider_crank_exact.h — exact motion of the slider-crank, a reference for errors.
//
//   From an event-driven solution in quadruple precision with minimal coordinates, independent of this code; two
//   tolerance sets agree to 1.2e-12 rad over 0.2 s. Initial conditions and parameters: SliderCrank's defaults.
//   Pointwise comparison over 0.2 s is well conditioned for e ≤ 0.4; with e = 0.9 to about 0.14 s only.
#pragma once

#include <optional>
#include <span>

namespace orthant {

struct SliderCrankExact {
  double mu, e;
  double theta1, theta2, omega1, omega2;  // at t = 0.2 s [rad, rad/s]
  double energy;                          // [J]
};
std::span<const SliderCrankExact> slider_crank_exact();
std::optional<SliderCrankExact> slider_crank_exact(double mu, double e);

/// Times [s] of the first five impacts of both top corners for μ = 0.01, e = 0.4.
std::span<const double> slider_crank_impact_times();

/// Without clearance and friction, at t = 0.2 s.
struct IdealSliderCrankExact {
  double theta1 = 18.39445098299741, omega1 = 97.13941142358436;  // [rad], [rad/s]
  double energy = 7.49554875;                                     // [J], constant
  double guide_force = 0.890051408;                               // [N] on the slider at t = 0
};

}  // namespace orthant
