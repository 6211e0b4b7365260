// core/scenes/spatial_slider_crank.h — rigid spatial slider-crank: a revolute, a spherical, a Hooke and a prismatic
// joint.
//
//   Crank of .08 m about x at (0, .1, .12) m, rod of .3 m, slider on the x axis; .12, .5, 2 kg; crank 1e-4 kg m² about
//   x, rod 4e-4 (its axis) and 4e-3; starts with the crank up and 6 rad/s; gravity along −z. The slider's axis of the
//   Hooke joint is x.
//   With a clearance a ball at the rod's end in a socket of the slider takes the place of the Hooke joint: the rod is
//   then free to spin about its axis, as in the mechanism with hooke = 0. With at_crank = 1 the ball is at the crank,
//   in a socket of the rod, in place of the spherical joint; the Hooke joint stays. With a guide the prismatic joint
//   gives way to a channel: the slider, a block of 6 × 3 × 3 cm, has that clearance to each of four walls.
//   Source: IFToMM library of computational benchmark problems; Haug, Computer Aided Kinematics and Dynamics of
//   Mechanical Systems (1989), 12.4.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct SpatialSliderCrank {
  double omega = 6, rod_spin = 4e-4;  // [rad/s, kg m²]
  int hooke = 1;                      // 0: a spherical joint in place of the Hooke joint
  template <class V> void visit(V&& v) {
    v("omega", omega, -1e4, 1e4), v("rod_spin", rod_spin, 1e-12, 8e-3), v("hooke", hooke, 0, 1);
  }
};

spatial::Scene spatial_slider_crank(const SpatialSliderCrank& p = {});

struct SliderCrankClearance {
  double omega = 6, rod_spin = 4e-4;                      // [rad/s, kg m²]
  double ball = 0.01, clearance = 5e-4, mu = 0.1, e = 0;  // [m] radius of the ball, that of the socket less it
  int at_crank = 0;                                       // 1: the ball is at the crank
  double guide = 0;                                       // [m] clearance to each wall; 0: a prismatic joint
  template <class V> void visit(V&& v) {
    v("omega", omega, -1e4, 1e4), v("rod_spin", rod_spin, 1e-12, 8e-3), v("ball", ball, 1e-6, 1.0);
    v("clearance", clearance, 1e-9, 1.0), v("mu", mu, 0.0, 1e6), v("e", e, 0.0, 1.0);
    v("at_crank", at_crank, 0, 1), v("guide", guide, 0.0, 1.0);
  }
};

spatial::Scene slider_crank_clearance(const SliderCrankClearance& p = {});

}  // namespace orthant
