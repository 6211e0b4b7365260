// core/scenes/n_four_bar.h — N-four-bar: N parallelogram linkages in a row that turn over together; exact motion.
//
//   N + 1 cranks and N couplers, uniform rods of 1 m and 1 kg, the cranks upright at first with tip speed v. One degree
//   of freedom (θ of the cranks from upright, clockwise) although each time all rods lie in one line, twice a turn, the
//   joint rows are dependent and a parallelogram could fold over.
//     ((N+1)/3 + N) θ̈ = g ((N+1)/2 + N) sin θ = ((N+1)/3 + N) k sin θ,   E = ½ ((N+1)/3 + N) v² + g ((N+1)/2 + N)
//   With b² = v² + 4k and k' = v / b:  θ = π + 2 am(b t/2 − K),  a turn takes 2π / agm(v, b).
// Source: González, Dopico, Luaces & Cuadrado, Multibody System Dynamics 16 (2006) 179-194 (benchmark N-four-bar).
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct NFourBar {
  int loops = 2;        // N
  double speed = 1;     // [m/s] v > 0, of the cranks' tips at the start
  double g = kGravity;  // [m/s²]

  template <class V> void visit(V&& v) { v("loops", loops, 1, 1000), v("speed", speed, 1e-3, 1e3); }

  double turn_time() const;   // [s] of a full turn
  double energy() const;      // [J] zero potential at the pivots' height
  Motion at(double t) const;  // θ, θ̇ [rad, rad/s]

 private:
  double stiffness() const;  // k [1/s²]
};

/// Bodies 0 … N are the cranks, N + 1 … 2N the couplers; crank i turns about (i, 0).
Scene n_four_bar(const NFourBar& p = {});

}  // namespace orthant
