// core/scenes/painleve_rod.h — Painlevé's rod: one end slides on a rough floor; contact force: one, none or two.
//
//   Half-length 1 m, mass 1 kg, angle φ to the floor, the lower end sliding so that friction pushes it under the rod.
//   λ solves 0 ≤ λ ⊥ A λ + b ≥ 0,   A = 1 + 3 cos² φ − 3 μ sin φ cos φ,   b = φ̇² sin φ − g.
//   A < 0 takes μ > 4/3 at the least (at tan φ = 2): then no acceleration is consistent (b < 0), or two are (b > 0).
//   At velocity level there is always an answer: without one at acceleration level the end strikes without approaching.
// Source: Génot & Brogliato, European Journal of Mechanics A 18 (1999) 653-677.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct PainleveRod {
  double mu = 1.5;
  double angle = 1.1071487177940904;  // [rad] φ, tan φ = 2
  double omega = 0;                   // [rad/s] φ̇
  double slide = 1;                   // [m/s] > 0 of the lower end, to the left
  double g = kGravity;                // [m/s²]

  template <class V> void visit(V&& v) {
    v("mu", mu, 0.0, 1e3), v("angle", angle, 0.1, 1.5), v("omega", omega, -1e3, 1e3), v("slide", slide, 1e-3, 1e3);
  }

  double A() const;                    // [1/kg]
  double b() const;                    // [m/s²]
  std::vector<double> forces() const;  // [N] every λ, ascending; empty: none
};

Scene painleve_rod(const PainleveRod& p = {});

}  // namespace orthant
