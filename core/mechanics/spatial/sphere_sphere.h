// core/mechanics/spatial/sphere_sphere.h — sphere-sphere contact.
//   g = |d| − radius_a − radius_b,  d = C_a − C_b   [m],  n = d / |d|; no normal where the centres meet.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>

#include <string>

namespace orthant::spatial {

struct SphereSphere {
  std::string name;
  BodyId a = kGround;
  Vector3d centre_a{0, 0, 0};  // [m] in a's frame
  double radius_a = 1;         // [m] > 0
  BodyId b = kGround;
  Vector3d centre_b{0, 0, 0};
  double radius_b = 1;
  ContactLaw law;

  double gap(const Kinematics& k) const { return line(k).norm() - radius_a - radius_b; }
  ContactRows rows(const Kinematics& k) const {
    const Vector3d n = line(k).normalized();
    return contact_rows(k, a, b, n, k.at(a).turn(centre_a) - radius_a * n, k.at(b).turn(centre_b) + radius_b * n);
  }

 private:
  Vector3d line(const Kinematics& k) const {
    return k.at(a).x + k.at(a).turn(centre_a) - k.at(b).x - k.at(b).turn(centre_b);
  }
};

}  // namespace orthant::spatial
