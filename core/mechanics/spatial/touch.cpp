#include <orthant/core/mechanics/spatial/touch.h>

#include <orthant/core/mechanics/spatial/polytope_polytope.h>
#include <orthant/core/mechanics/spatial/round_polytope.h>
#include <orthant/core/mechanics/spatial/round_shapes.h>

#include <algorithm>

namespace orthant::spatial {
namespace {

TouchPoint swapped(const TouchPoint& p) { return {-p.n, p.on_b, p.on_a, p.gap}; }

void to_world(const Pose& at, TouchPoints& points) {
  for (int i = 0; i < points.count; ++i) {
    TouchPoint& p = points.points[static_cast<std::size_t>(i)];
    p = {at.turn(p.n), at.x + at.turn(p.on_a), at.x + at.turn(p.on_b), p.gap};
  }
}

/// Orders the points along an oblique direction of a's frame: two poses near each other number them alike. A body's
/// edges and diagonals are seldom square to it.
void number_alike(const Pose& at_a, TouchPoints& points) {
  const Vector3d along = at_a.turn(Vector3d(0.6172, 0.5393, 0.5729));
  std::stable_sort(points.points.begin(), points.points.begin() + points.count,
                   [&](const TouchPoint& x, const TouchPoint& y) { return along.dot(x.on_a) < along.dot(y.on_a); });
}

TouchPoints touch_any(const Pose& at_a, const Shape& a, const Pose& at_b, const Shape& b) {
  TouchPoints points;
  if (!a.polytope() && !b.polytope()) return touch_round(core_of(at_a, a), a.radius, core_of(at_b, b), b.radius);
  if (a.polytope() && b.polytope()) {
    points = touch_polytopes(*a.hull, *b.hull, at_a.R.transpose() * at_b.R, at_a.turn_back(at_b.x - at_a.x));
    to_world(at_a, points);
    return points;
  }
  const bool round_first = !a.polytope();
  const Shape &round = round_first ? a : b, &polytope = round_first ? b : a;
  const Pose& at = round_first ? at_b : at_a;
  const Segment world = core_of(round_first ? at_a : at_b, round);
  points = touch_core({at.turn_back(world.p - at.x), at.turn_back(world.q - at.x)}, round.radius, *polytope.hull);
  to_world(at, points);
  if (!round_first)
    for (int i = 0; i < points.count; ++i) {
      TouchPoint& p = points.points[static_cast<std::size_t>(i)];
      p = swapped(p);
    }
  return points;
}

}  // namespace

int most_points(const Shape& a, const Shape& b) {
  if (a.sphere() || b.sphere()) return 1;
  return a.capsule() && b.capsule() ? 3 : TouchPoints::kMost;
}

TouchPoints touch(const Pose& at_a, const Shape& a, const Pose& at_b, const Shape& b) {
  TouchPoints points = touch_any(at_a, a, at_b, b);
  const auto size = [](const Shape& s) {
    return s.polytope() ? s.hull->size : s.radius + (s.corners.back() - s.corners.front()).norm();
  };
  number_alike(at_a, points);
  points.open = std::min(size(a), size(b));
  if (points.count > 0) {
    double least = points.points[0].gap;
    for (int i = 1; i < points.count; ++i) least = std::min(least, points.at(i).gap);
    points.open += std::max(least, 0.0);
  } else {
    const Vector3d from = at_b.x + at_b.turn(b.corners.front()), way = at_a.x + at_a.turn(a.corners.front()) - from;
    const Vector3d n = way.isZero(0) ? Vector3d(0, 0, 1) : Vector3d(way.normalized());
    points.points[0] = {n, from + points.open * n, from, points.open};
  }
  return points;
}

}  // namespace orthant::spatial
