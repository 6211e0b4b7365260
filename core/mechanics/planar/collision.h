// core/mechanics/planar/collision.h — collision sets: contacts between any two of many shapes, without a listed contact
// per pair.
//
//   Stands for a disc-disc, disc-polygon or polygon-polygon contact between every two shapes of different bodies, in
//   the order (1, 2), (1, 3), …, (2, 3), …; broad_phase.h finds, once a step, the few that can touch in it. They are
//   the contacts of the system behind the listed ones, numbered again each step.
#pragma once

#include <orthant/core/mechanics/pair.h>
#include <orthant/core/mechanics/planar/disc_polygon.h>
#include <orthant/core/mechanics/planar/polygon_polygon.h>

namespace orthant {

struct Shape {
  BodyId body = kGround;
  Vector2d centre{0, 0};  // [m] of a disc, in the body's frame
  double radius = 1;      // [m] > 0 of a disc
  Polygon corners;        // [m] in the body's frame; empty: a disc
  Exposed exposed = {};   // of the polygon; set by System
};

struct Collision {
  std::string name;
  std::vector<Shape> shapes;  // a body may have several, which do not meet each other
  ContactLaw law;
  double neighbours = 6;  // > 0; room for so many pairs a shape that are near each other at a time, on the average
};

/// Calls what(pair) for the pair's contacts: two polygons have two.
template <class What> void each_point(const Collision& c, Pair pair, What&& what) {
  what(pair);
  const auto polygon = [&](int i) { return !c.shapes[static_cast<std::size_t>(i)].corners.empty(); };
  if (polygon(pair.a) && polygon(pair.b)) pair.point = 1, what(pair);
}

/// Calls what(pair) for all that it stands for.
template <class What> void each_pair(const Collision& c, What&& what) {
  const auto n = static_cast<int>(c.shapes.size());
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b)
      if (c.shapes[static_cast<std::size_t>(a)].body != c.shapes[static_cast<std::size_t>(b)].body)
        each_point(c, {0, a, b, 0}, what);
}

/// Calls what(contact) with what the pair is at the moment, as a contact of its own.
template <class What>
decltype(auto) as_contact(const Collision& c, const Pair& pair, const Kinematics& k, What&& what) {
  const Shape *x = &c.shapes[static_cast<std::size_t>(pair.a)], *y = &c.shapes[static_cast<std::size_t>(pair.b)];
  if (!x->corners.empty() && !y->corners.empty())
    return std::visit(
        what, touch(k, {x->body, x->corners, x->exposed.get()}, {y->body, y->corners, y->exposed.get()}, pair.point));
  if (x->corners.empty() && y->corners.empty())
    return what(DiscDisc{{}, x->body, x->centre, x->radius, y->body, y->centre, y->radius, {}});
  if (!x->corners.empty()) std::swap(x, y);
  return std::visit(what, touch(k, x->body, x->centre, x->radius, y->body, y->corners, y->exposed.get()));
}

}  // namespace orthant
