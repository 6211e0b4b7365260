// core/scenes/bennett.h — Bennett's linkage: four rods and four skew hinges; movable in spite of the number of its
// joint rows.
//
//   Rods a, b, a, b between hinges whose axes are twisted by α, β, α, β, sin α / a = sin β / b; the last rod b is the
//   ground, hinge 1 at the origin along +z. 20 rows of rank 17.
//   θ1: the turn of the first rod about hinge 1, from the ground's rod continued. Thin rods of 1 kg/m.
//   Gravity along −z, from rest at θ1 = 1.2: θ1(5 s) = 3.01649731398 (for the defaults).
//   Closed by Denavit-Hartenberg frames: Π Rz(θ_i) Tx(a_i) Rx(α_i) = 1 with θ3 = −θ1, θ4 = −θ2,
//     tan(θ1/2) tan(θ2/2) = sin((α+β)/2) / sin((β−α)/2).
//   Source: Bennett, Engineering 76 (1903) 777-778; Hunt, Kinematic Geometry of Mechanisms (1978), ch. 11.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct Bennett {
  double a = 1, b = 0.7, twist = 70;  // [m, m, °]
  double theta1 = 1.2;                // [rad]
  double gx = 0, gy = 0, gz = -9.81;  // [m/s²]
  template <class V> void visit(V&& v) {
    v("a", a, 1e-3, 1e3), v("b", b, 1e-3, 1e3), v("twist", twist, 0.0, 90.0), v("theta1", theta1, -3.1, 3.1);
    v("gx", gx, -1e3, 1e3), v("gy", gy, -1e3, 1e3), v("gz", gz, -1e3, 1e3);
  }
};

spatial::Scene bennett(const Bennett& p = {});

}  // namespace orthant
