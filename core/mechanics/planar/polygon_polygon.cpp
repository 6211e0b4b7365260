#include <orthant/core/mechanics/planar/polygon_polygon.h>

#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kFlat = 0.1;  // sine of the tilt

struct Side {  // one of the two polygons
  BodyId body;
  const Polygon& corners;
  const Pose& pose;
  Vector2d corner(std::size_t i) const { return pose.x + pose.turn(corners[i]); }
};

struct Axis {
  double separation = -std::numeric_limits<double>::infinity();
  std::size_t face = 0, nearest = 0;  // nearest: the other's corner
};

/// The face of x beyond which y lies farthest.
Axis separating(const Side& x, const Side& y) {
  Axis best;
  for (std::size_t i = 0; i < x.corners.size(); ++i) {
    const Vector2d n = x.pose.turn(outward(x.corners, i)), n_y = y.pose.turn_back(n);
    const double offset = n.dot(y.pose.x - x.corner(i));
    Axis axis{std::numeric_limits<double>::infinity(), i, 0};
    for (std::size_t j = 0; j < y.corners.size(); ++j)
      if (const double s = offset + n_y.dot(y.corners[j]); s < axis.separation) axis.separation = s, axis.nearest = j;
    if (axis.separation > best.separation) best = axis;
  }
  return best;
}

CornerWall corner_face(const Side& c, std::size_t corner, const Side& f, std::size_t face) {
  return {{}, c.body, c.corners[corner], f.body, f.corners[face], outward(f.corners, face), {}};
}
DiscDisc corner_corner(const Side& x, std::size_t i, const Side& y, std::size_t j) {
  return {{}, x.body, x.corners[i], 0, y.body, y.corners[j], 0, {}};
}

}  // namespace

Touch touch(const Kinematics& k, BodyId a, const Polygon& corners_a, BodyId b, const Polygon& corners_b, int point) {
  const Side side_a{a, corners_a, k.at(a)}, side_b{b, corners_b, k.at(b)};
  const Axis from_a = separating(side_a, side_b), from_b = separating(side_b, side_a);
  const bool on_a = from_a.separation > from_b.separation;
  const Side &x = on_a ? side_a : side_b, &y = on_a ? side_b : side_a;
  const Axis& axis = on_a ? from_a : from_b;

  // y's face at its nearest corner, turned to the reference: it runs against it.
  const std::size_t i = axis.face, here = axis.nearest, before = (here ? here : y.corners.size()) - 1;
  const Vector2d e = x.pose.turn(direction(x.corners, i));
  const auto along = [&](std::size_t face) { return e.dot(y.pose.turn(direction(y.corners, face))); };
  const bool starts_here = along(here) < along(before);
  const std::size_t j = starts_here ? here : before, i_end = next(x.corners, i), j_end = next(y.corners, j);

  const bool high_along_a = (point & 1) == static_cast<int>((i + j) & 1), high = on_a == high_along_a;
  const double length = e.dot(x.corner(i_end) - x.corner(i));
  const double y_high = e.dot(y.corner(j) - x.corner(i)), y_low = e.dot(y.corner(j_end) - x.corner(i));
  const std::size_t y_corner = high ? j : j_end;  // at the end wanted

  const double tilt = std::abs(cross(e, y.pose.turn(direction(y.corners, j))));
  if (tilt > kFlat || along(j) > 0) {
    const double at = high ? y_high : y_low;
    if (y_corner == here && axis.separation > 0 && (at < 0 || at > length))
      return corner_corner(y, here, x, at < 0 ? i : i_end);
    return corner_face(y, y_corner, x, i);
  }
  if (y_low > length || y_high < 0) {  // side by side they are not
    if (axis.separation > 0) return y_low > length ? corner_corner(y, j_end, x, i_end) : corner_corner(y, j, x, i);
    return corner_face(y, here, x, i);
  }
  if (high) return y_high <= length ? corner_face(y, j, x, i) : corner_face(x, i_end, y, j);
  return y_low >= 0 ? corner_face(y, j_end, x, i) : corner_face(x, i, y, j);
}

}  // namespace orthant
