// core/mechanics/planar/contact_sets.h — contact sets: several contacts of a pair of bodies. Names: NAME_1, NAME_2, …
#pragma once

#include <orthant/core/mechanics/planar/corner_wall.h>
#include <orthant/core/mechanics/planar/polygon_polygon.h>

#include <array>

namespace orthant {

/// Both points of two polygons.
inline std::array<PolygonPolygon, 2> polygon_polygon(PolygonPolygon pair) {
  std::array<PolygonPolygon, 2> both{pair, pair};
  for (int i = 0; i < 2; ++i)
    both[static_cast<std::size_t>(i)].name += "_" + std::to_string(i + 1), both[static_cast<std::size_t>(i)].point = i;
  return both;
}

/// Every corner of a polygon of `wall.a` against a wall; wall.point is not read.
inline std::vector<CornerWall> polygon_wall(const CornerWall& wall, const Polygon& corners) {
  std::vector<CornerWall> all(corners.size(), wall);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].name += "_" + std::to_string(i + 1), all[i].point = corners[i];
  return all;
}

/// A prismatic joint with clearance: a rectangular slider between two parallel walls, four corners against one wall
/// each.
struct Guide {
  std::string name;
  BodyId a = kGround;                // the slider
  Vector2d centre{0, 0};             // [m] of the rectangle, in a's frame; its sides are a's axes
  double width = 1, height = 1;      // [m] > 0 along a's x and y
  BodyId b = kGround;                // carries the walls
  Vector2d point{0, 0}, axis{1, 0};  // [m] on the centre line, its unit direction; in b's frame
  double clearance = 0;              // [m] ≥ 0 on each side when the slider is in the middle
  ContactLaw law;
};
/// Of the corners (−, +), (+, +), (−, −), (+, −); the first two meet the wall on the left of the axis.
inline std::array<CornerWall, 4> guide(const Guide& g) {
  std::array<CornerWall, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = i % 2 == 0 ? -1 : 1, y = i < 2 ? 1 : -1;
    const Vector2d left = y * perp(g.axis);
    corners[i] = {g.name + "_" + std::to_string(i + 1),
                  g.a,
                  g.centre + Vector2d(x * g.width / 2, y * g.height / 2),
                  g.b,
                  g.point + (g.height / 2 + g.clearance) * left,
                  -left,
                  g.law};
  }
  return corners;
}

}  // namespace orthant
