// core/mechanics/planar/disc_disc.h — disc-disc contact: each disc fixed in a body (or one of them in the ground).
//   g = |d| − radius_a − radius_b,  d = C_a − C_b, n = d / |d|   [m].   d = 0 has no normal: the rows are zero.
#pragma once

#include <orthant/core/mechanics/planar/contact_law.h>

#include <string>

namespace orthant {

struct DiscDisc {
  std::string name;
  BodyId a = kGround;
  Vector2d centre_a{0, 0};  // [m] in a's frame
  double radius_a = 1;      // [m] > 0
  BodyId b = kGround;
  Vector2d centre_b{0, 0};  // [m] in b's frame
  double radius_b = 1;      // [m] > 0
  ContactLaw law;

  double gap(const Kinematics& k) const { return line(k).norm() - radius_a - radius_b; }
  ContactRows rows(const Kinematics& k) const {
    const Vector2d n = line(k).normalized();
    const Vector2d r_a = k.at(a).turn(centre_a) - radius_a * n, r_b = k.at(b).turn(centre_b) + radius_b * n;
    return {pair_row(a, b, n, r_a, r_b), pair_row(a, b, tangent_of(n), r_a, r_b)};
  }
  ContactBias bias(const Kinematics& k) const {
    const Vector2d d = line(k), n = d.normalized(), t = tangent_of(n);
    const Vector2d r_a = k.at(a).turn(centre_a), r_b = k.at(b).turn(centre_b);
    const double wa = k.rate(a).omega, wb = k.rate(b).omega;
    const Vector2d rate = k.rate(a).at(r_a) - k.rate(b).at(r_b), pull = wb * wb * r_b - wa * wa * r_a;
    const double length = d.norm(), turn = length > 0 ? perp(n).dot(rate) / length : 0;  // angular velocity of n
    return {n.dot(pull) + turn * perp(n).dot(rate), turn * perp(t).dot(rate) + t.dot(pull)};
  }

 private:
  Vector2d line(const Kinematics& k) const {
    return k.at(a).x + k.at(a).turn(centre_a) - k.at(b).x - k.at(b).turn(centre_b);
  }
};

}  // namespace orthant
