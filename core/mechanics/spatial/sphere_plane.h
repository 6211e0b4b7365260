// core/mechanics/spatial/sphere_plane.h — sphere-plane contact: a sphere of body a, a half-space of body b; radius 0:
// a corner.
//   g = n · (C − W) − radius,  C = x_a + R_a centre   [m]; the contact point is P = C − radius n.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>

#include <string>
#include <vector>

namespace orthant::spatial {

struct SpherePlane {
  std::string name;
  BodyId a = kGround;
  Vector3d centre{0, 0, 0};  // [m] in a's frame
  double radius = 1;         // [m] ≥ 0
  BodyId b = kGround;
  Vector3d plane_point{0, 0, 0}, normal{0, 0, 1};  // [m], unit; in b's frame
  ContactLaw law;

  double gap(const Kinematics& k) const {
    return k.at(b).turn(normal).dot(k.at(a).x + k.at(a).turn(centre) - k.at(b).x) - normal.dot(plane_point) - radius;
  }
  ContactRows rows(const Kinematics& k) const {
    const Vector3d n = k.at(b).turn(normal), r_a = k.at(a).turn(centre) - radius * n;
    return contact_rows(k, a, b, n, r_a, k.at(a).x + r_a - k.at(b).x);
  }
};

/// Every corner of a polytope of `plane.a` against a plane; plane.centre and plane.radius are not read. Names: NAME_1,
/// NAME_2, …
inline std::vector<SpherePlane> corners_plane(const SpherePlane& plane, const std::vector<Vector3d>& corners) {
  std::vector<SpherePlane> all(corners.size(), plane);
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i].name += "_" + std::to_string(i + 1), all[i].centre = corners[i], all[i].radius = 0;
  return all;
}

/// The eight corners of a box about the origin, of half the size in each direction [m].
inline std::vector<Vector3d> box_corners(const Vector3d& half) {
  std::vector<Vector3d> corners;
  for (const double x : {-1, 1})
    for (const double y : {-1, 1})
      for (const double z : {-1, 1}) corners.emplace_back(x * half.x(), y * half.y(), z * half.z());
  return corners;
}

}  // namespace orthant::spatial
