// core/scenes/arch.h — semicircular arch of voussoirs without mortar, and the least thickness at which it stands.
//
//   Mean radius 1 m, thickness t, N equal voussoirs with radial joints, no sliding, no tension. The thrust line has to
//   stay within: the arch falls by hinges at the crown (outside), the haunches (inside) and the springings (outside).
//   With a hinge at the angle β from the crown, r = 1 ∓ t/2, γ the weight per area, W = γ (r_o² − r_i²) β / 2 above β:
//     H_β (r_o − r_i cos β) = W r_i sin β − γ (r_o³ − r_i³)(1 − cos β)/3    least thrust that holds this part up
//     H_s r_o               = W_{π/2} r_o − γ (r_o³ − r_i³)/3               largest thrust the springing can take
//   Least thickness: max_β H_β = H_s over the joints β.  Any β: t = 0.10747804 at β = 54.48° (Milankovitch).
// Each joint face of a voussoir is a wall for two corners of the next one; the ground has the first and the last face.
// Source: Makris & Alexakis, Archive of Applied Mechanics 83 (2013) 1345-1366.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct Arch {
  int voussoirs = 10;        // N, even: then one joint is at the crown
  double thickness = 0.115;  // [m] t
  double mu = 0.7;           // more than the 0.4 or so at which joints would slide
  double g = kGravity;       // [m/s²]

  template <class V> void visit(V&& v) {
    v("voussoirs", voussoirs, 2, 1000), v("thickness", thickness, 1e-3, 1.0), v("mu", mu, 0.0, 1e3);
  }

  double least_thickness() const;  // [m] of N voussoirs
};

/// Body i − 1 is voussoir i from the right springing to the left one; contacts 2j, 2j + 1: joint j = 0 … N, inside and
/// outside. Density 1 kg/m².
Scene arch(const Arch& p = {});

}  // namespace orthant
