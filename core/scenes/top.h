// core/scenes/top.h — Lagrange's top: a symmetric body turns about a fixed tip under its weight.
//
//   I1 = .002, I3 = .0008 kg m² about the tip, m = .5 kg, l = .04 m; axis at 30° to the vertical, spin ω3, no
//   precession at first: it falls, and rises again to cusps. Nutation 30° … 31.68007640528°, period .10996771481 s,
//   precession .18417249693 rad a nutation (by elliptic integrals, for the defaults).
//   Source: Goldstein, Poole & Safko, Classical Mechanics (2002), 5.7.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct Top {
  double mass = 0.5, l = 0.04, I1 = 2e-3, I3 = 8e-4, g = 9.81;  // [kg, m, kg m², kg m², m/s²]
  double tilt = 30, spin = 150;                                 // [°, rad/s]
  template <class V> void visit(V&& v) {
    v("mass", mass, 1e-9, 1e9), v("l", l, 0.0, 1e3), v("I1", I1, 1e-12, 1e9), v("I3", I3, 1e-12, 1e9);
    v("g", g, 0.0, 1e3), v("tilt", tilt, 0.0, 180.0), v("spin", spin, -1e6, 1e6);
  }
};

spatial::Scene top(const Top& p = {});

}  // namespace orthant
