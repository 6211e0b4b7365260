// core/mechanics/spatial/collision.h — collision sets in space: contacts between any two of many shapes, without a
// listed contact per pair.
//
//   Stands for the contacts between every two shapes of different bodies (touch.h: up to four points), in the order
//   (1, 2), (1, 3), …, (2, 3), …; broad_phase.h finds, once a step, the few that can touch in it.
#pragma once

#include <orthant/core/mechanics/pair.h>
#include <orthant/core/mechanics/spatial/contact_rows.h>
#include <orthant/core/mechanics/spatial/sphere_plane.h>
#include <orthant/core/mechanics/spatial/touch.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace orthant::spatial {

struct Collision {
  std::string name;
  std::vector<Shape> shapes;  // a body may have several, which do not meet each other
  ContactLaw law;
  double neighbours = 6;  // > 0; room for so many pairs a shape that are near each other at a time, on the average
  std::vector<std::pair<BodyId, BodyId>> apart = {};  // bodies whose shapes do not meet each other
};

/// The present state of a pair, as a contact of its own.
struct TouchContact {
  BodyId a = kGround, b = kGround;
  TouchPoint point;

  double gap(const Kinematics& /*k*/) const { return point.gap; }
  ContactRows rows(const Kinematics& k) const {
    return contact_rows(k, a, b, point.n, point.on_a - k.at(a).x, point.on_b - k.at(b).x);
  }
};

/// A shape of `plane.a` against a plane: its corners, grown by its radius. Names: of a sphere NAME, else NAME_1, …
std::vector<SpherePlane> shape_plane(SpherePlane plane, const Shape& shape);

/// Sets the hulls of polytopes, and which of their faces neighbours in the same body cover. Throws
/// std::invalid_argument where hull_of does.
void set_hulls(Collision& collision);

inline int most_points(const Collision& c, const Pair& pair) {
  return most_points(c.shapes[static_cast<std::size_t>(pair.a)], c.shapes[static_cast<std::size_t>(pair.b)]);
}
/// Of any two of the shapes.
inline int most_points(const Collision& c) {
  const auto any = [&](bool (Shape::*kind)() const) {
    return std::any_of(c.shapes.begin(), c.shapes.end(), [&](const Shape& s) { return (s.*kind)(); });
  };
  return any(&Shape::polytope) ? TouchPoints::kMost : any(&Shape::capsule) ? 3 : 1;
}

/// Calls what(pair) for each point of the pair.
template <class What> void each_point(const Collision& c, Pair pair, What&& what) {
  const int most = most_points(c, pair);
  for (pair.point = 0; pair.point < most; ++pair.point) what(pair);
}

inline TouchPoints touch(const Collision& c, const Pair& pair, const Kinematics& k) {
  const Shape &x = c.shapes[static_cast<std::size_t>(pair.a)], &y = c.shapes[static_cast<std::size_t>(pair.b)];
  return touch(k.at(x.body), x, k.at(y.body), y);
}

template <class What>
decltype(auto) as_contact(const Collision& c, const Pair& pair, const Kinematics& k, What&& what) {
  const Shape &x = c.shapes[static_cast<std::size_t>(pair.a)], &y = c.shapes[static_cast<std::size_t>(pair.b)];
  return what(TouchContact{x.body, y.body, touch(c, pair, k).at(pair.point)});
}

}  // namespace orthant::spatial
