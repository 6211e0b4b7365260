// core/mechanics/spatial/rim_plane.h — rim-plane contact: a circle on body a, such as a disc's edge, against a
// half-space of body b.
//   u: the circle's axis, d: the direction in its plane that goes down most, turned about u by `phase`:
//   g = n · (C + radius d − W) − tube   [m],  contact point P = C + radius d − tube n.
//   phase = 0 is the lowest point: it moves over the body, and the row at P is the gap's exact derivative all the same.
//   Further points (cylinders and cones have three a rim) hold the body where it stands on the whole rim; tilted, they
//   are open. Where the rim is parallel to the plane, d is a direction of the body.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>
#include <orthant/core/mechanics/spatial/sphere_plane.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace orthant::spatial {

struct RimPlane {
  std::string name;
  BodyId a = kGround;
  Vector3d centre{0, 0, 0};  // [m] in a's frame
  Vector3d axis{0, 0, 1};    // unit, in a's frame
  double radius = 1;         // [m] > 0
  double tube = 0;           // [m] ≥ 0: the circle is grown by this
  double phase = 0;          // [rad]
  BodyId b = kGround;
  Vector3d plane_point{0, 0, 0}, normal{0, 0, 1};  // [m], unit; in b's frame
  ContactLaw law;

  /// The sine of the angle between the two planes. Tilts of this size [rad] turn d about; 0: d is held by the body.
  double steepness(const Kinematics& k) const {
    const double sine = downhill(k.at(a).turn(axis), k.at(b).turn(normal)).norm();
    return sine > kFlat ? sine : 0;
  }
  double gap(const Kinematics& k) const {
    const Vector3d n = k.at(b).turn(normal);
    return n.dot(k.at(a).x + point(k, n) - k.at(b).x) - normal.dot(plane_point) - tube;
  }
  ContactRows rows(const Kinematics& k) const {
    const Vector3d n = k.at(b).turn(normal), r_a = point(k, n) - tube * n;
    return contact_rows(k, a, b, n, r_a, k.at(a).x + r_a - k.at(b).x);
  }

 private:
  static constexpr double kFlat = 1e-12;
  /// In the circle's plane.
  static Vector3d downhill(const Vector3d& u, const Vector3d& n) { return u.dot(n) * u - n; }
  /// From a's centre, in the world.
  Vector3d point(const Kinematics& k, const Vector3d& n) const {
    const Vector3d u = k.at(a).turn(axis);
    Vector3d d = downhill(u, n);
    const double sine = d.norm();
    d = sine > kFlat ? Vector3d(d / sine) : k.at(a).turn(perpendicular(axis));
    if (phase != 0) d = std::cos(phase) * d + std::sin(phase) * u.cross(d);
    return k.at(a).turn(centre) + radius * d;
  }
};

/// Three points of a rim. Names: NAME_1, NAME_2, NAME_3.
inline std::vector<RimPlane> standing_rim(const RimPlane& rim, int first = 1) {
  std::vector<RimPlane> all(3, rim);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].name += "_" + std::to_string(first + static_cast<int>(i));
    all[i].phase = 2 * std::numbers::pi / 3 * static_cast<double>(i);
  }
  return all;
}

}  // namespace orthant::spatial
