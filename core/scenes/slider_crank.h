// core/scenes/slider_crank.h — planar slider-crank with clearance between slider and guide.
//
//   Parameters: Flores, Leine & Glocker, Multibody System Dynamics 23 (2010) 165-190. The crank is not driven; it
//   starts at θ₁ = θ₂ = 0 with ω₁ = 150 rad/s. The slider's four corners meet the guide's walls y = ± (b + clearance):
//   corner1 (−a, +b) and corner2 (+a, +b) the top wall, corner3 (−a, −b) and corner4 (+a, −b) the bottom wall.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

namespace orthant {

struct SliderCrank {
  double l1 = 0.153, l2 = 0.306;                 // [m] crank, rod
  double a = 0.05, b = 0.025;                    // [m] slider's half-length, half-height
  double m1 = 0.038, m2 = 0.038, m3 = 0.076;     // [kg]
  double J1 = 7.4e-5, J2 = 5.9e-4, J3 = 2.7e-6;  // [kg m²]
  double g = 9.81;                               // [m/s²] along −y
  double omega1 = 150, omega2 = -75;             // [rad/s]
  double mu = 0.01, e = 0.4, e_t = 0;            // of all four corners
  double clearance = 0.001;                      // [m] each side
  double theta3 = 0, omega3 = 0;  // [rad], [rad/s] the slider's initial tilt; ω₃ = −0.01 is the literature's "B"

  template <class V> void visit(V&& v) {
    v("mu", mu, 0.0, 1e6), v("e", e, 0.0, 1.0), v("e_t", e_t, -1.0, 1.0), v("clearance", clearance, 0.0, 1.0);
    v("theta3", theta3, -1.0, 1.0), v("omega3", omega3, -1e6, 1e6);
  }
};

Scene slider_crank(const SliderCrank& p = {});

/// The same mechanism without clearance: the slider slides along y = 0. Clearance, friction and restitution are not
/// read.
Scene slider_crank_ideal(const SliderCrank& p = {});

}  // namespace orthant
