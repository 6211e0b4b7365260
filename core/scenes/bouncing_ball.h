// core/scenes/bouncing_ball.h — bouncing ball: a point mass falls on a floor; exact motion.
//
//   Dropped from rest at `height`; t₁ = √(2 height / g), impact speeds g t₁ eⁿ⁻¹. Impact n is at
//     tₙ = t₁ (1 + 2 e (1 − eⁿ⁻¹) / (1 − e)),   e = 1:  tₙ = (2n − 1) t₁;
//   for e < 1 they accumulate at t∞ = t₁ (1 + e) / (1 − e) (Zeno), and the ball rests from then on.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct BouncingBall {
  double height = 1, e = 0.5;  // [m], restitution
  double mass = 1;             // [kg]
  double g = kGravity;         // [m/s²]

  template <class V> void visit(V&& v) {
    v("height", height, 0.0, 1e6), v("e", e, 0.0, 1.0), v("mass", mass, 1e-6, 1e6);
  }

  double impact_time(int n) const;  // [s] of impact n = 1, 2, …
  double zeno_time() const;         // [s] t∞; infinite for e = 1
  int impacts(double t) const;      // up to and with t; an int's largest from t∞ on
  Motion at(double t) const;
};

Scene bouncing_ball(const BouncingBall& p = {});

}  // namespace orthant
