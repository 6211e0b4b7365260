// core/mechanics/planar/disc_polygon.h — disc-polygon contact: a disc of body a, a convex polygon of body b.
//   g = signed distance of the disc's centre to the polygon − radius   [m]. The centre's Voronoi region decides whether
//   the disc meets a face (disc_wall.h) or a corner (disc_disc.h, of radius 0); inside, it is the nearest face. The gap
//   is continuous, and smooth except for centres inside.   O(corners).
// Source: Ericson, Real-Time Collision Detection (2005), ch. 5.
#pragma once

#include <orthant/core/mechanics/planar/disc_disc.h>
#include <orthant/core/mechanics/planar/disc_wall.h>
#include <orthant/core/mechanics/planar/exposure.h>

#include <limits>
#include <optional>
#include <variant>

namespace orthant {

using DiscTouch = std::variant<DiscWall, DiscDisc>;

/// Feature that a disc meets where neighbours cover some of the polygon's faces and corners: c is its centre in b's
/// frame, `most` beyond the face that it is farthest beyond. Off the ends of free faces, where no corner is met, it is
/// open by kAside.
/// Nothing: below the free faces; the nearest point of the polygon is right there.
inline std::optional<DiscTouch> touch_free(BodyId a, const Vector2d& centre, double radius, BodyId b,
                                           const Polygon& corners, const Exposure& exposed, const Vector2d& c,
                                           double most) {
  std::size_t best = 0;
  double beyond = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d from = c - corners[i];
    const bool nearest =
        direction(corners, i).dot(from) <= 0 && direction(corners, i ? i - 1 : corners.size() - 1).dot(from) >= 0;
    if (most > 0 && nearest && exposed.points_to(i, from.normalized()))
      return DiscDisc{{}, a, centre, radius, b, corners[i], 0, {}};
    if (const double distance = outward(corners, i).dot(from); exposed.face[i].free && distance > beyond)
      beyond = distance, best = i;
  }
  const Vector2d along = direction(corners, best), n = outward(corners, best);
  const bool above = along.dot(c - corners[best]) >= 0 && along.dot(c - corners[next(corners, best)]) <= 0;
  const double shortest = shortest_face(corners);
  double aside = kAside;
  if (!exposed.face[best].free)
    aside = kCovered;
  else if (most <= 0 || (above && beyond >= most))
    aside = 0;
  else if (beyond - radius < -kAside / 2 * shortest)
    return {};
  return DiscWall{{}, a, centre, radius, b, corners[best] - aside * shortest * n, n, {}};
}

/// Feature of a polygon of body b that a disc of body a meets: a face, or a corner.
inline DiscTouch touch(const Kinematics& k, BodyId a, const Vector2d& centre, double radius, BodyId b,
                       const Polygon& corners, const Exposure* exposed = nullptr) {
  const Vector2d c = k.at(b).turn_back(k.at(a).x + k.at(a).turn(centre) - k.at(b).x);
  double most = -std::numeric_limits<double>::infinity();
  std::size_t face = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (const double distance = outward(corners, i).dot(c - corners[i]); distance > most) most = distance, face = i;
  if (exposed != nullptr)
    if (const auto free = touch_free(a, centre, radius, b, corners, *exposed, c, most)) return *free;
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
  Exposed exposed = {};  // set by System

  double gap(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.gap(k); }, nearest(k));
  }
  /// [m] As if the polygon stood alone: no more than gap(), and without jumps.
  double whole_gap(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.gap(k); }, touch(k, a, centre, radius, b, corners));
  }
  ContactRows rows(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.rows(k); }, nearest(k));
  }
  ContactBias bias(const Kinematics& k) const {
    return std::visit([&](const auto& c) { return c.bias(k); }, nearest(k));
  }

 private:
  DiscTouch nearest(const Kinematics& k) const { return touch(k, a, centre, radius, b, corners, exposed.get()); }
};

}  // namespace orthant
