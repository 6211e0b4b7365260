// core/scenes/chain.h — chain pendulum: N point masses of 1 kg on massless links of 1 m, all released at one angle.
//
//   Released horizontally the motion is chaotic for N ≥ 2, so its exact answers are constants: by a Runge-Kutta method
//   of order 8 in the N angles, independent of this code; two tolerances agree to 1.5e-11 rad.
//   Small swings: θ = Σ modes, ω²L/g the roots of the Laguerre polynomial L_N.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

#include <numbers>
#include <span>

namespace orthant {

struct Chain {
  int links = 2;
  double angle = std::numbers::pi / 2;  // [rad] of every link from downward, counter-clockwise
  double g = kGravity;                  // [m/s²]

  template <class V> void visit(V&& v) { v("links", links, 1, 1000000), v("angle", angle, -3.2, 3.2); }
};

/// The support is the origin, the energy at rest at its height is 0.
Scene chain(const Chain& p = {});

struct ChainExact {
  int links;
  double t;         // [s]
  double theta[3];  // [rad] of the links from downward
  double tip[2];    // [m]
};
/// From horizontal rest.
std::span<const ChainExact> chain_exact();

}  // namespace orthant
