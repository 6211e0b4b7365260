// core/scenes/flyball.h — flyball governor on stiff springs.
//
//   A shaft (1 × .01 × .01 m, 3000 kg/m³) turns about the vertical; two rods of the same kind are hinged to it at
//   (± .05, 0, 1) m, 5 kg at their ends; a slider (a cube of .1 m, 3 kg) moves along the shaft; springs (8e5 N/m,
//   4e4 N s/m, .5 m long) go from the slider at (± .05, 0, 0) to the rods' middles. Starts with the slider at s = .5 m,
//   rods 30° below the horizontal, ω = 2π rad/s.
//   Source: IFToMM library of computational benchmark problems, A05.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct Flyball {
  double stiffness = 8e5, damping = 4e4;  // [N/m, N s/m]
  template <class V> void visit(V&& v) { v("stiffness", stiffness, 0.0, 1e12), v("damping", damping, 0.0, 1e12); }
};

spatial::Scene flyball(const Flyball& p = {});

}  // namespace orthant
