// core/scenes/rattleback.h — rattleback: an ellipsoid with skew axes of inertia, which turns in one sense only.
//
//   Spun against its preferred sense (spin < 0) it rattles and turns back; spun in this sense it continues.
//   Semi-axes .2, .03, .02 m, the centre of mass .01 m below the centre, 1 kg; moments 2e-4, 1.6e-3, 1.7e-3 and the
//   product −2e-5 kg m² of the two horizontal axes.
//   Source: Kane, Levinson, Realistic mathematical modeling of the rattleback, Int. J. Non-Linear Mechanics 17 (1982)
//   175.
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant {

struct Rattleback {
  double spin = -5, tilt = 0.5, skew = -2e-5, mu = 1;  // [rad/s, degrees about the long axis, kg m²]
  template <class V> void visit(V&& v) {
    v("spin", spin, -1e3, 1e3), v("tilt", tilt, -60.0, 60.0), v("skew", skew, -5e-4, 5e-4), v("mu", mu, 0.0, 1e6);
  }
};

spatial::Scene rattleback(const Rattleback& p = {});

}  // namespace orthant
