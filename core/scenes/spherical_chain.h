// core/scenes/spherical_chain.h — chain of N rods with ball joints, to measure growth with the number of links.
//
//   The rods of 1 m and 1 kg hang from the origin by their first end and are released along x. Each swings about y, and
//   a push of the last one across the plane makes the motion spatial.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct SphericalChain {
  int links = 10;
  double radius = 0.05;  // of a rod [m]
  double push = 1;       // of the last rod, along y [m/s]
  double g = kGravity;   // [m/s²]

  template <class V> void visit(V&& v) {
    v("links", links, 1, 1000000), v("radius", radius, 1e-3, 0.5), v("push", push, -1e3, 1e3), v("g", g, 0.0, 1e3);
  }
};

/// Body i is a cylinder along its z, joint i its upper end.
spatial::Scene spherical_chain(const SphericalChain& p = {});

}  // namespace orthant
