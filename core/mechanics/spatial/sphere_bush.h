// core/mechanics/spatial/sphere_bush.h — sphere-bush contact: a ball inside a hollow cylinder of another body.
//
//   d = C_a − C_b,  d⊥ = d − (u · d) u,  u the cylinder's axis   [m]
//   g = radius_b − radius_a − |d⊥|,  n = −d⊥ / |d⊥|
// The cylinder has no ends; axial stops are limits on a Slide. At d⊥ = 0 there is no normal; the gap is the whole
// clearance there, so the contact is open.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>

#include <string>

namespace orthant::spatial {

struct SphereBush {
  std::string name;
  BodyId a = kGround;          // the ball
  Vector3d centre_a{0, 0, 0};  // [m] in a's frame
  double radius_a = 1;         // [m] > 0
  BodyId b = kGround;          // the hollow cylinder
  Vector3d centre_b{0, 0, 0};  // [m] a point of its axis, in b's frame
  Vector3d axis_b{0, 0, 1};    // unit vector, likewise
  double radius_b = 1.001;     // [m] > radius_a
  ContactLaw law;

  double gap(const Kinematics& k) const { return radius_b - radius_a - across(k).norm(); }
  ContactRows rows(const Kinematics& k) const {
    const Vector3d d = across(k);
    if (!(d.squaredNorm() > 0)) return {{a, b, {}, {}}, {Row{a, b, {}, {}}, Row{a, b, {}, {}}}};
    const Vector3d n = -d.normalized(), r_a = k.at(a).turn(centre_a);
    // The axis' point next to the ball is C_a − d⊥.
    const Vector3d foot = k.at(a).x + r_a - d;
    return contact_rows(k, a, b, n, r_a - radius_a * n, foot - radius_b * n - k.at(b).x);
  }

  /// d⊥, in the world.
  Vector3d across(const Kinematics& k) const {
    const Vector3d u = k.at(b).turn(axis_b);
    const Vector3d d = k.at(a).x + k.at(a).turn(centre_a) - k.at(b).x - k.at(b).turn(centre_b);
    return d - u.dot(d) * u;
  }
};

}  // namespace orthant::spatial
