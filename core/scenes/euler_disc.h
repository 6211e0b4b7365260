// core/scenes/euler_disc.h — Euler's disc: a thin coin rolls on its edge around a circle, its centre at rest.
//
//   With the centre of mass at rest the contact runs round with Ω² = 4 g / (R sin α), α the tilt of the disc; the
//   angular velocity is Ω sin α along the diameter through the contact. Without losses the tilt stays.
//   Source: Moffatt, Euler's disk and its finite-time singularity, Nature 404 (2000) 833; O'Reilly, The dynamics of
//   rolling disks and sliding disks, Nonlinear Dynamics 10 (1996) 287.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct EulerDisc {
  double radius = 0.0375, mass = 0.44, tilt = 20, g = 9.81, mu = 0.5;  // [m, kg, degrees, m/s²]
  template <class V> void visit(V&& v) {
    v("radius", radius, 1e-6, 1e3), v("mass", mass, 1e-9, 1e9), v("tilt", tilt, 0.1, 89.0), v("g", g, 1e-3, 1e3);
    v("mu", mu, 0.0, 1e6);
  }
};

spatial::Scene euler_disc(const EulerDisc& p = {});

}  // namespace orthant
