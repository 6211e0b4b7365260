// core/mechanics/planar/disc_polygon.h — a disc of body a against a convex polygon of body b.
//   g = signed distance of the disc's centre to the polygon − radius   [m]. The centre's Voronoi region decides whether the
//   disc meets a face (disc_wall.h) or a corner (disc_disc.h, of radius 0); inside, it is the nearest face. The gap is
//   continuous, and smooth but for centres inside.   O(corners).
// Source: Ericson, Real-Time Collision Detection (2005), ch. 5.
#pragma once

#include <orthant/core/mechanics/planar/disc_disc.h>
#include <orthant/core/mechanics/planar/disc_wall.h>
#include <orthant/core/mechanics/planar/polygon.h>

#include <limits>
#include <variant>

namespace orthant {

/// What a disc of body a meets of a polygon of body b: a face, or a corner.
inline std::variant<DiscWall, DiscDisc> touch(const Kinematics& k, BodyId a, const Vector2d& centre, double radius,
                                              BodyId b, const Polygon& corners) {
  const Vector2d c = k.at(b).turn_back(k.at(a).x + k.at(a).turn(centre) - k.at(b).x);
  double most = -std::numeric_limits<double>::infinity();
  std::size_t face = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (const double distance = outward(corners, i).dot(c - corners[i]); distance > most) most = distance, face = i;
  if (most > 0) {  // outside: beyond an end of this face, one of its corners is the nearest
    const Vector2d along = direction(corners, face), first = corners[face], last = corners[next(corners, face)];
    if (along.dot(c - first) < 0) return DiscDisc{{}, a, centre, radius, b, first, 0, {}};
    if (along.dot(c - last) > 0) return DiscDisc{{}, a, centre, radius, b, last, 0, {}};
  }
  return DiscWall{{}, a, centre, radius, b, corners[face], outward(corners, face), {}};
}

struct DiscPolygon {
  std::string name;
  BodyId a = kGround;
  Vector2d centre{0, 0};  // [m] in a's frame
  double radius = 1;      // [m] > 0
  BodyId b = kGround;
  Polygon corners;  // [m] in b's frame
  ContactLaw law;

  double gap(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.gap(k); }, nearest(k));
  }
  ContactRows rows(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.rows(k); }, nearest(k));
  }
  ContactBias bias(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.bias(k); }, nearest(k));
  }

 private:
  std::variant<DiscWall, DiscDisc> nearest(const Kinematics& k) const {
    return touch(k, a, centre, radius, b, corners);
  }
};

}  // namespace orthant
