// core/scenes/rocking_block.h — rocking block (Housner): a block rocks from corner to corner; exact motion.
//
//   Half-width b, half-height h, R² = b² + h², tan α = b/h, p² = 3g/(4R). Tilted by θ₀ about a corner and let go:
//     θ̈ = −p² sin(α − θ),  θ > 0;   φ = α − θ is a pendulum from upright, so that θ is an elliptic function of time.
//   Each time it stands upright the other corner strikes. Inelastic and without slip it continues with
//     ω⁺ = η ω⁻,  η = 1 − (3/2) sin² α,  while h > b/√2; a flatter block (η ≤ 0) stops at once.
//   Impacts n = 1, 2, … from the amplitudes cos(α − θₙ) = cos α + η²ⁿ (cos(α − θ₀) − cos α) and the times T(θₙ) of
//   falling from them:  t₁ = T(θ₀), tₙ₊₁ = tₙ + 2 T(θₙ).
// Source: Housner, Bulletin of the Seismological Society of America 53 (1963) 403-417 (his period is linearized, this
// is not).
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct RockingBlock {
  double half_width = 0.1, half_height = 0.4;  // [m]
  double tilt = 0.5;                           // θ₀ / α in (0, 1)
  double mu = 1;                               // enough that it does not slip
  double g = kGravity;                         // [m/s²]

  template <class V> void visit(V&& v) {
    v("half_width", half_width, 1e-3, 1e3), v("half_height", half_height, 1e-3, 1e3), v("tilt", tilt, 1e-6, 0.999999);
    v("mu", mu, 0.0, 1e3);
  }

  double slenderness() const;        // [rad] α
  double ratio() const;              // η, 0 where it stops dead
  double impact_time(int n) const;   // [s] n = 1, 2, …; infinite where it stopped dead before
  double impact_speed(int n) const;  // [rad/s] |ω⁻|
  Motion at(double t) const;         // θ, θ̇ [rad, rad/s]: > 0 on the left corner

 private:
  double turning(int n) const;  // φ at the turning point after impact n [rad]
  double fall(int n) const;     // [s] T(θₙ)
  double rate() const;          // [1/s] p
};

/// Contact 0 is the left corner, 1 the right one.
Scene rocking_block(const RockingBlock& p = {});

}  // namespace orthant
