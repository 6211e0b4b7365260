// core/scenes/masse.h — massé shot: a ball on a rough table slides along a parabola, then rolls straight on.
//
//   The slip keeps its direction and decreases by 7/2 μ g a second; it is 0 at t = 2 |slip| / (7 μ g). For the defaults
//   t = .6147302241381 s at (.275969961, .150564996), v = (−.102142857, .489857143),
//   ω = (−17.142857, −3.574553, 40).
//   Source: Coriolis, Théorie mathématique des effets du jeu de billard (1835).
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct Masse {
  double radius = 0.028575, mass = 0.17, g = 9.81, mu = 0.2;  // [m, kg, m/s²]
  double vx = 1, vy = 0, wx = -60, wy = -100, wz = 40;        // [m/s, rad/s]
  template <class V> void visit(V&& v) {
    v("radius", radius, 1e-6, 1e3), v("mass", mass, 1e-9, 1e9), v("g", g, 0.0, 1e3), v("mu", mu, 0.0, 1e6);
    v("vx", vx, -1e6, 1e6), v("vy", vy, -1e6, 1e6);
    v("wx", wx, -1e6, 1e6), v("wy", wy, -1e6, 1e6), v("wz", wz, -1e6, 1e6);
  }
};

spatial::Scene masse(const Masse& p = {});

}  // namespace orthant
