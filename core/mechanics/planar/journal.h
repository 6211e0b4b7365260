// core/mechanics/planar/journal.h — journal bearing, a revolute joint with clearance: a disc of a inside a hole of b.
//   g = (radius_b − radius_a) − |d|,  d = C_a − C_b   [m]; contact at the hole's surface, in the direction of d.
// The formulas are those of disc_disc.h with a negative radius of the journal, and gap and rows of the opposite sign.
// At d = 0 there is no direction and the rows are zero; no contact is closed there, as the clearance is > 0.
// Source: Flores, Ambrósio, Claro & Lankarani, Kinematics and Dynamics of Multibody Systems with Imperfect Joints
// (2008).
#pragma once

#include <orthant/core/mechanics/planar/disc_disc.h>

namespace orthant {

struct Journal {
  std::string name;
  BodyId a = kGround;
  Vector2d centre_a{0, 0};  // [m] in a's frame
  double radius_a = 1;      // [m] > 0, of the journal
  BodyId b = kGround;
  Vector2d centre_b{0, 0};  // [m] in b's frame
  double radius_b = 2;      // [m] > radius_a, of the bearing
  ContactLaw law;

  double gap(const Kinematics& k) const { return -discs().gap(k); }
  ContactRows rows(const Kinematics& k) const {
    const ContactRows outside = discs().rows(k);
    return {scaled(outside.normal, -1), scaled(outside.tangent, -1)};
  }
  ContactBias bias(const Kinematics& k) const {
    const ContactBias outside = discs().bias(k);
    return {-outside.normal, -outside.tangent};
  }

 private:
  DiscDisc discs() const { return {{}, a, centre_a, -radius_a, b, centre_b, radius_b, {}}; }
};

}  // namespace orthant
