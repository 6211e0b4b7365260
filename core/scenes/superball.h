// core/scenes/superball.h — superball: a light ball above a heavy one, both falling onto a floor; speeds afterwards.
//
//   Masses r m below and m above, both at speed v before, no gravity.
//   In turn (a small gap between the balls, or impacts = sequential): the lower one turns round at e v and meets the
//   upper:
//     e = 1:  upper v (3r − 1)/(r + 1), lower v (r − 3)/(r + 1); for r < 3 the lower strikes the floor again.
//   At once (gap 0, impacts = simultaneous): Newton's law requires γ⁺ = e v at the floor and 0 between the balls,
//   Poisson's
//     releases e times what compression stored: both balls leave at e v, by either law.
// The step is a power of two, so that a gap of 0 stays 0 while both fall.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

namespace orthant {

struct SuperBall {
  double ratio = 3;   // r
  double e = 1;       // of both contacts
  double speed = 1;   // [m/s] v > 0
  double gap = 1e-6;  // [m] ≥ 0 between the balls
  Impacts impacts = Impacts::simultaneous;
  Restitution restitution = Restitution::newton;

  template <class V> void visit(V&& v) {
    v("ratio", ratio, 1e-9, 1e9), v("e", e, 0.0, 1.0), v("speed", speed, 1e-3, 1e3), v("gap", gap, 0.0, 0.1);
    v("impacts", impacts, kImpactsNames), v("restitution", restitution, kRestitutionNames);
  }

  struct Speeds {
    double lower = 0, upper = 0;  // [m/s] > 0 upwards
  };
  double impact_time() const { return 0.125 / speed; }  // [s] of the first impact
  Speeds after() const;                                 // after the last one; exact for gap 0 or e = 1
};

Scene superball(const SuperBall& p = {});

}  // namespace orthant
