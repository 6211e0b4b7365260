// core/mechanics/spatial/socket.h — spherical joint with clearance: a ball in a socket.
//   g = radius_b − radius_a − |d|,  d = C_a − C_b   [m],  n = −d / |d|: the ball of a inside the hollow sphere of b.
// At d = 0 there is no normal; the gap is the whole clearance there, so the contact is open.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>

#include <string>

namespace orthant::spatial {

struct Socket {
  std::string name;
  BodyId a = kGround;
  Vector3d centre_a{0, 0, 0};  // [m] in a's frame
  double radius_a = 1;         // [m] > 0
  BodyId b = kGround;
  Vector3d centre_b{0, 0, 0};
  double radius_b = 1.001;  // [m] > radius_a
  ContactLaw law;

  double gap(const Kinematics& k) const { return radius_b - radius_a - line(k).norm(); }
  ContactRows rows(const Kinematics& k) const {
    const Vector3d d = line(k);
    if (!(d.squaredNorm() > 0)) return {{a, b, {}, {}}, {Row{a, b, {}, {}}, Row{a, b, {}, {}}}};
    const Vector3d n = -d.normalized();
    return contact_rows(k, a, b, n, k.at(a).turn(centre_a) - radius_a * n, k.at(b).turn(centre_b) - radius_b * n);
  }

 private:
  Vector3d line(const Kinematics& k) const {
    return k.at(a).x + k.at(a).turn(centre_a) - k.at(b).x - k.at(b).turn(centre_b);
  }
};

}  // namespace orthant::spatial
