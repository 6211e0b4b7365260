// core/mechanics/scene/toml/spatial_fields.h — common keys of elements in space: bodies, points, axes, orientations.
#pragma once

#include "spatial_reader.h"

#include <cmath>
#include <numbers>

namespace orthant::scene_file {

/// A unit vector at right angles to u, next to `near` where that is not along u.
inline Vector3d square_to(const Vector3d& u, const Vector3d& near) {
  const Vector3d left = near - u.dot(near) * u;
  return left.norm() > 1e-9 ? Vector3d(left.normalized()) : spatial::perpendicular(u);
}

template <class T> void SpatialReader::points_of(Fields& f, T& x) const {
  const toml::node* node = f.find("bodies", Form::bodies, true);
  if (node == nullptr) f.fail(f.table(), "missing key \"bodies\"");
  const toml::array* names = node->as_array();
  if (names == nullptr || names->size() != 2) f.refuse("bodies", *node, "two names [\"first\", \"second\"]");
  x.a = id(f, "bodies", *names->get(0)), x.b = id(f, "bodies", *names->get(1));
  if constexpr (requires { x.point_a; }) f.maybe("point_a", x.point_a), f.maybe("point_b", x.point_b);
}

/// `axis` in a's frame, `axis_b` in b's: left out, it is the same direction in the initial poses.
template <class T> void SpatialReader::axes_of(Fields& f, T& x) const {
  if (!f.direction("axis", x.axis_a, true)) f.miss("axis");
  if (!f.direction("axis_b", x.axis_b))
    x.axis_b = initial_.at(x.b).turn_back(initial_.at(x.a).turn(x.axis_a)).normalized();
}

/// `angle` [rad] in the initial poses; 0.
template <class T> void SpatialReader::angle_of(Fields& f, T& x) const {
  double angle = 0;
  if (f.maybe("angle", angle) && !(std::abs(angle) <= std::numbers::pi))
    f.refuse("angle", *f.table().get("angle"), "from -pi to pi: an angle in space is known up to full turns");
  const Vector3d u = initial_.at(x.a).turn(x.axis_a), from = spatial::perpendicular(x.axis_a);
  const Vector3d world = Eigen::AngleAxisd(angle, u) * initial_.at(x.a).turn(from);
  x.reference_a = from, x.reference_b = square_to(x.axis_b, initial_.at(x.b).turn_back(world));
}

/// `orientation` of b in a; left out, that of the initial poses.
template <class T> void SpatialReader::orientation_of(Fields& f, T& x) const {
  const auto of = [&](BodyId b) {
    return b < 0 ? Eigen::Vector4d(1, 0, 0, 0) : scene_.bodies[static_cast<std::size_t>(b)].orientation;
  };
  if (!f.maybe("orientation", x.orientation))
    x.orientation = quaternions::product(quaternions::inverse(of(x.a)), of(x.b));
  if (x.orientation.isZero(0))
    f.refuse("orientation", *f.table().get("orientation"), "a quaternion [w, x, y, z], not zero");
  x.orientation.normalize();
}

}  // namespace orthant::scene_file
