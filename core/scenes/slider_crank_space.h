// core/scenes/slider_crank_space.h — slider-crank of slider_crank.h, built from spatial bodies and turned by any
// angles.
//
//   Joints: shaft (ground-crank), crankpin (crank-rod), wristpin (rod-slider), revolute, axes along z of the mechanism.
//   Contacts: the slider's corners 1 … 4 of slider_crank.h in the mid-plane; with width > 0 eight, at z = ± width/2:
//   corner1a, corner1b, … The whole mechanism, gravity included, is turned by R = R_z R_y R_x (angles turn_x, …).
//   In-plane motion is that of the planar scene. Moments of inertia about other axes do not matter: rods and a cube.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/core/scenes/slider_crank.h>

namespace orthant {

struct SliderCrankSpace : SliderCrank {
  double turn_x = 0, turn_y = 0, turn_z = 0;  // [rad]
  double width = 0;                           // [m] of the slider

  template <class V> void visit(V&& v) {
    SliderCrank::visit(v);
    v("turn_x", turn_x, -1e3, 1e3), v("turn_y", turn_y, -1e3, 1e3), v("turn_z", turn_z, -1e3, 1e3);
    v("width", width, 0.0, 1.0);
  }
};

spatial::Scene slider_crank_space(const SliderCrankSpace& p = {});

}  // namespace orthant
