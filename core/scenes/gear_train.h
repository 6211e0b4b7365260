// core/scenes/gear_train.h — gear train with backlash: wheels in mesh with play, the first one driven to and fro.
//
//   Wheel i of radius r_i turns about z, neighbours in mesh: c_{i+1} = −r_i/r_{i+1} c_i within the play. The first one
//   turns with amplitude × sin(omega t). The last one is three times as thick, a flywheel, and braked. At each reversal
//   the teeth part, cross the play and strike: relative rates change by −e.
//   Source: the rattle model of Pfeiffer & Kunert, Rattling models from deterministic to stochastic processes,
//   Nonlinear Dynamics 1 (1990) 63–74: wheels that strike across their backlash.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct GearTrain {
  int wheels = 3;
  double play = 0.02, e = 0.3;         // [rad] of each wheel after the first, from flank to flank
  double amplitude = 0.5, omega = 12;  // [rad, rad/s] of the drive
  double brake = 0.002;                // [N m s] damping of the last bearing
  template <class V> void visit(V&& v) {
    v("wheels", wheels, 2, 1000), v("play", play, 0.0, 0.3), v("e", e, 0.0, 1.0);
    v("amplitude", amplitude, 0.0, 100.0), v("omega", omega, 0.0, 1e4), v("brake", brake, 0.0, 1e6);
  }
};

spatial::Scene gear_train(const GearTrain& p = {});

}  // namespace orthant
