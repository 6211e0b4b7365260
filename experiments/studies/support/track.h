// experiments/studies/support/track.h — tracked vehicle: a closed chain of links round two wheels, on the ground.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

namespace orthant {

/// A sixth of the links lies on each wheel; the rest is above and below, half of it on the ground. Pins are discs that
/// wheels and ground carry by friction. A motor turns the rear wheel from rest. The axle of the front wheel slides in
/// the hull, and a spring tightens the track.
struct Track {
  int links = 150;        // a multiple of 6, at least 24
  double pitch = 0.1;     // [m] from pin to pin
  double pin = 0.02;      // [m] radius
  double mu = 0.6;        // of pins on wheels and ground
  double speed = 1;       // [m/s] at the end of `ramp`, if nothing slips
  double ramp = 2;        // [s]; until then the motor follows speed/2 (1 − cos(π t/ramp))
  double tension = 2000;  // [N] of the spring
};

Scene track(const Track& t = {});

}  // namespace orthant
