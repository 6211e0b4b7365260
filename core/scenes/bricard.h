// core/scenes/bricard.h — Bricard's linkage: a closed chain of six hinged rods on the edges of a cube; one of them is
// the ground.
//
//   Hinges at (0,0,0), (1,0,0), (1,−1,0), (1,−1,1), (0,−1,1), (0,0,1) m, axes y, z, x, y, z, x; five rods of 1 kg,
//   1 × .1 × .1 m, between them; gravity along −y; starts at rest. 30 rows of rank 29 in every pose.
//   Exact: displacements of every second hinge are equal, a and b, with (1 + sin a)(1 + sin b) = 1.
//   Source: IFToMM library of computational benchmark problems, A04; González, Dopico, González & Cuadrado, A
//   benchmarking system for MBS simulation software, Multibody System Dynamics 16 (2006) 179-190.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct Bricard {
  double g = 9.81;  // [m/s²] along −y
  template <class V> void visit(V&& v) { v("g", g, 0.0, 1e3); }
};

spatial::Scene bricard(const Bricard& p = {});

}  // namespace orthant
