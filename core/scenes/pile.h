// core/scenes/pile.h — pile: N discs dropped into a trough, a few columns wide, to measure growth with their number.
//
//   Radii within a tenth of each other and places shifted by up to a tenth of a radius (a fixed pattern, no random
//   numbers), so that the pile does not balance on its columns. The number of rows is N / columns.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct Pile {
  int discs = 100;
  double radius = 0.05;  // [m]
  double mu = 0.3;
  double e = 0;
  double g = kGravity;  // [m/s²]

  template <class V> void visit(V&& v) {
    v("discs", discs, 1, 1000000), v("radius", radius, 1e-3, 1e3), v("mu", mu, 0.0, 1e3), v("e", e, 0.0, 1.0),
        v("g", g, 0.0, 1e3);
  }
};

/// Discs of 1 kg/m² by their areas; contacts 3i, 3i + 1, 3i + 2 are disc i with floor, left and right wall; one
/// collision.
Scene pile(const Pile& p = {});

}  // namespace orthant
