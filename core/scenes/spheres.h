// core/scenes/spheres.h — pile of N spheres dropped into a square well, to measure growth with their number.
//
//   The pile in space: radii within a tenth of each other, and places shifted by up to a tenth of a radius (a fixed
//   pattern, no random numbers), so that no sphere balances on another. About ∛N spheres stand along each wall.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct Spheres {
  int count = 64;
  double radius = 0.05;  // of the largest [m]
  double mu = 0.3;
  double e = 0;
  double g = kGravity;  // [m/s²]

  template <class V> void visit(V&& v) {
    v("count", count, 1, 1000000), v("radius", radius, 1e-3, 1e3), v("mu", mu, 0.0, 1e6), v("e", e, 0.0, 1.0),
        v("g", g, 0.0, 1e3);
  }
};

/// Spheres of 1000 kg/m³. Contacts 5i … 5i + 4 are sphere i with the floor and the four walls; one collision set.
spatial::Scene spheres(const Spheres& p = {});

}  // namespace orthant
