// core/scenes/elliptic.h — elliptic functions by the arithmetic-geometric mean, for pendulum-like motions.
//
//   agm(a, b): aₙ₊₁ = (aₙ + bₙ)/2, bₙ₊₁ = √(aₙ bₙ);  K(k) = π / (2 agm(1, k')),  k' = √(1 − k²)
//   φ = am(u, k) inverts u = ∫₀^φ dθ / √(1 − k² sin² θ):  φ_N = 2ᴺ a_N u,  φₙ₋₁ = (φₙ + asin(cₙ sin φₙ / aₙ)) / 2
// Both converge quadratically: some six steps to rounding. k' is given, and not k, because 1 − k² cancels near k = 1.
// Source: Abramowitz & Stegun (1964), 16.4 and 17.6.
#pragma once

namespace orthant {

double agm(double a, double b);

/// K(k) for k' in (0, 1].
double quarter_period(double k_prime);

/// am(u, k) for k' in (0, 1]; sn = sin am. Loses digits as |u| eps.
double amplitude(double u, double k_prime);

/// u = F(φ, k) for φ in [0, π/2], k' in (0, 1]: the inverse of am, by Newton's method from below (am is concave there).
double elliptic_integral(double phi, double k_prime);

}  // namespace orthant
