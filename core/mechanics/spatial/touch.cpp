#include <orthant/core/mechanics/spatial/touch.h>

#include <orthant/core/mechanics/spatial/polytope_polytope.h>
#include <orthant/core/mechanics/spatial/round_shapes.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace orthant::spatial {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TouchPoint swapped(const TouchPoint& p) { return {-p.n, p.on_b, p.on_a, p.gap}; }

/// A point grown by a radius and a polytope, in the polytope's frame; false: nothing of it can be touched from there.
bool touch_point(const Vector3d& p, double radius, const Hull& hull, TouchPoint& result) {
  double deepest = -kInf, least = kInf;
  const Hull::Face* face_of = nullptr;
  Vector3d nearest_point(0, 0, 0);
  bool covered = false;
  const auto corner = [&](int i) -> const Vector3d& { return hull.corners[static_cast<std::size_t>(i)]; };
  for (const Hull::Face& face : hull.faces) {
    const double height = face.normal.dot(p) - face.offset;
    if (!face.covered && height > deepest) deepest = height, face_of = &face;
    if (!(height > 0)) continue;
    Vector3d on = p - height * face.normal;
    bool off = face.covered, within = true;
    double nearest_edge = kInf;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const Segment side{corner(face.corners[i]), corner(face.corners[(i + 1) % face.corners.size()])};
      if (face.normal.dot((side.q - side.p).cross(p - side.p)) >= 0) continue;
      within = false;
      const Vector3d candidate = side.at(side.nearest(p));
      const double away = (p - candidate).squaredNorm();
      if (away < nearest_edge || (away == nearest_edge && off))
        nearest_edge = away, on = candidate, off = !hull.edges[static_cast<std::size_t>(face.edges[i])].meets(p - on);
    }
    const double away = within ? height * height : nearest_edge;
    if (away < least) least = away, nearest_point = on, covered = off;
  }
  if (least < kInf) {
    result = grown(p, radius, nearest_point, 0);
    return !covered;
  }
  if (face_of == nullptr) return false;
  result = {face_of->normal, p - radius * face_of->normal, p - deepest * face_of->normal, deepest - radius};
  return true;
}

bool inside(double s) { return s > 0 && s < 1; }

/// A sphere or capsule, its core in the polytope's frame, and the polytope.
TouchPoints touch_core(const Segment& core, double radius, const Hull& hull) {
  TouchPoints points;
  std::array<TouchPoint, 8> found;
  std::size_t count = 0;
  if (touch_point(core.p, radius, hull, found[count])) ++count;
  if (core.p != core.q) {
    if (touch_point(core.q, radius, hull, found[count])) ++count;
    std::array<TouchPoint, 2> crossed;  // the two nearest edges that the segment crosses
    int crossings = 0;
    for (const Hull::Edge& e : hull.edges) {
      if (e.covered) continue;
      const Segment edge{hull.corners[static_cast<std::size_t>(e.from)], hull.corners[static_cast<std::size_t>(e.to)]};
      const auto [s, t] = nearest(core, edge);
      if (!inside(s) || !inside(t)) continue;
      const TouchPoint p = grown(core.at(s), radius, edge.at(t), 0);
      if (p.n.dot(e.left_normal) < 0 || p.n.dot(e.right_normal) < 0 || !e.meets(p.n) ||
          !(hull.depth_of(core.at(s)) > 0))
        continue;
      if (crossings < 2)
        crossed[static_cast<std::size_t>(crossings++)] = p;
      else if (TouchPoint& worse = crossed[0].gap > crossed[1].gap ? crossed[0] : crossed[1]; p.gap < worse.gap)
        worse = p;
    }
    for (int i = 0; i < crossings; ++i) found[count++] = crossed[static_cast<std::size_t>(i)];
  }
  add_sorted(found, count, kSamePoint * hull.size, points);
  return points;
}

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
