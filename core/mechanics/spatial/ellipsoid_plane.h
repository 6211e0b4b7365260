// core/mechanics/spatial/ellipsoid_plane.h — ellipsoid-plane contact: an ellipsoid of body a, a half-space of body b.
//   m = Rᵀ n in the ellipsoid's axes, A = diag(semi_axes):
//   g = n · (C − W) − |A m|   [m],  contact point P = C − R A² m / |A m|, the lowest one: it moves over the body, and
//   the row at P is the gap's exact derivative all the same.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>

#include <string>

namespace orthant::spatial {

struct EllipsoidPlane {
  std::string name;
  BodyId a = kGround;
  Vector3d centre{0, 0, 0};                 // [m] in a's frame
  Vector3d semi_axes{1, 1, 1};              // [m] > 0
  Eigen::Vector4d orientation{1, 0, 0, 0};  // quaternion, the ellipsoid's axes → a's frame
  BodyId b = kGround;
  Vector3d plane_point{0, 0, 0}, normal{0, 0, 1};  // [m], unit; in b's frame
  ContactLaw law;

  double gap(const Kinematics& k) const {
    const Vector3d n = k.at(b).turn(normal);
    return n.dot(k.at(a).x + k.at(a).turn(centre) - k.at(b).x) - normal.dot(plane_point) -
           semi_axes.cwiseProduct(in_axes(k, n)).norm();
  }
  ContactRows rows(const Kinematics& k) const {
    const Vector3d n = k.at(b).turn(normal), m = in_axes(k, n);
    const Vector3d lowest = -semi_axes.cwiseAbs2().cwiseProduct(m) / semi_axes.cwiseProduct(m).norm();
    const Vector3d r_a = k.at(a).turn(centre + quaternions::matrix_of(orientation) * lowest);
    return contact_rows(k, a, b, n, r_a, k.at(a).x + r_a - k.at(b).x);
  }

 private:
  Vector3d in_axes(const Kinematics& k, const Vector3d& n) const {
    return quaternions::matrix_of(orientation).transpose() * k.at(a).turn_back(n);
  }
};

}  // namespace orthant::spatial
