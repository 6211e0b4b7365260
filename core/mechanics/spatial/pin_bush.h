// core/mechanics/spatial/pin_bush.h — pin-bush contact: a cylindrical joint with clearance (a journal in space); two
// rims.
//
//   A rim: a circle of the shorter part, against the cylinder of the other part; this cylinder has no ends.
//   Rim of the pin (a):    g = radius_b − max |P⊥|,  P on the circle, P⊥ its part square to b's axis, from that axis
//   Rim of the bush (b):   g = min |P⊥| − radius_a,  likewise from a's axis; |P⊥| < 0 where the axis is outside [m]
//   n = −P⊥ / |P⊥|. The circle, seen along the other one's axis, is an ellipse with the half-axes r (along e) and c r,
//   c = |u · w| of the two axes, and its centre at d. In the quadrant of d, or across from it, the extreme point is at
//   the one φ with
//     d_e sin φ − c d_f cos φ ± r (1 − c²) sin φ cos φ = 0   (+ farthest, − nearest).
// The gap is exact for any tilt; its derivative is the row at P. Axial stops are limits on a Slide.
// Where both axes coincide all points are extreme: an arbitrary one is taken, at the whole clearance.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>

#include <string>
#include <vector>

namespace orthant::spatial {

struct PinBush {
  std::string name;
  BodyId a = kGround;                           // the pin
  Vector3d centre_a{0, 0, 0}, axis_a{0, 0, 1};  // [m], unit vector; in a's frame
  double radius_a = 1;                          // [m] > 0
  BodyId b = kGround;                           // the bush
  Vector3d centre_b{0, 0, 0}, axis_b{0, 0, 1};  // likewise
  double radius_b = 1.001;                      // [m] > radius_a
  bool rim_of_pin = true;                       // else of the bush
  double along = 0;                             // [m] of the rim, from its body's centre along its axis
  ContactLaw law;

  double gap(const Kinematics& k) const {
    const double distance = rim(k).distance;
    return rim_of_pin ? radius_b - distance : distance - radius_a;
  }
  ContactRows rows(const Kinematics& k) const {
    const Rim at = rim(k);
    const Vector3d n = -at.outwards;
    const Vector3d other = at.point - (at.distance - (rim_of_pin ? radius_b : radius_a)) * at.outwards;
    return contact_rows(k, a, b, n, (rim_of_pin ? at.point : other) - k.at(a).x,
                        (rim_of_pin ? other : at.point) - k.at(b).x);
  }

 private:
  struct Rim {
    Vector3d point, outwards;  // P in the world; P⊥ / |P⊥|
    double distance;           // |P⊥|, < 0 of an axis outside of the bush's rim
  };
  Rim rim(const Kinematics& k) const;
};

/// Both rims of the pin, or of the bush, whose length is given [m]; `along` is not read. Names: NAME_1, NAME_2.
inline std::vector<PinBush> pin_in_bush(const PinBush& pin, double length) {
  std::vector<PinBush> both(2, pin);
  both[0].name += "_1", both[0].along = -length / 2;
  both[1].name += "_2", both[1].along = length / 2;
  return both;
}

}  // namespace orthant::spatial
