// core/scenes/impact_oscillator.h — impact oscillator: a driven oscillator that strikes a wall; exact periodic motion.
//
//   ẍ + x = cos(ω t + φ),  x ≤ 0,  ẋ⁺ = −e ẋ⁻ at x = 0;  mass and stiffness are 1.
//   With one impact a period T = 2π/ω, C = 1/(1 − ω²), between impacts at t = 0 and T
//     x = −C cos φ (cos t + tan(T/2) sin t) + C cos(ω t + φ),
//     tan φ = −(1 − e) / ((1 + e) ω) tan(T/2),    ẋ⁻ = C (cos φ tan(T/2) − ω sin φ) > 0 chooses φ's branch.
//   The time origin is an impact, so that φ is the load's phase. A disturbance of this motion shrinks by the factor e a
//   period (both Floquet multipliers have |μ| = e where they are complex, as they are for the default).
//   Admissible where x ≤ 0 all the time: ω > 1 not near 2 (resonance, T/2 = π/2 … ); 1.4 … 1.8 and 2.2 … 2.6 at e =
//   0.8.
// Source: Shaw & Holmes, Journal of Sound and Vibration 90 (1983) 129-155.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct ImpactOscillator {
  double omega = 1.6, e = 0.8;  // [rad/s], restitution
  double disturbance = 0;       // [m/s] added to the start's velocity

  template <class V> void visit(V&& v) {
    v("omega", omega, 1.1, 10.0), v("e", e, 0.0, 1.0), v("disturbance", disturbance, -100.0, 100.0);
  }

  double period() const;        // [s]
  double phase() const;         // [rad] φ in (−π, π]
  double impact_speed() const;  // [m/s] ẋ⁻
  Motion at(double t) const;    // undisturbed; at an impact the velocity after it
};

Scene impact_oscillator(const ImpactOscillator& p = {});

}  // namespace orthant
