#include <orthant/core/mechanics/spatial/touch.h>

#include <orthant/core/mechanics/spatial/round_shapes.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace orthant::spatial {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kSameFace = 1e-6;  // of the size: the face of b is taken only where it is better than a's by this
constexpr double kEdges = 1e-5;     // likewise edges instead of faces: shapes that lie on each other have four points

TouchPoint swapped(const TouchPoint& p) { return {-p.n, p.on_b, p.on_a, p.gap}; }

/// Whether the edge can be touched in the direction d from it.
bool meets(const Hull::Edge& edge, const Vector3d& d) { return !edge.covered && d.dot(edge.beyond) <= 0; }

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
        nearest_edge = away, on = candidate, off = !meets(hull.edges[static_cast<std::size_t>(face.edges[i])], p - on);
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
      if (p.n.dot(e.left_normal) < 0 || p.n.dot(e.right_normal) < 0 || !meets(e, p.n) ||
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

using Corners = std::array<Vector3d, kMostHullPoints>;

struct Axis {
  double gap = -kInf;
  double covered = -kInf;  // the largest gap along a face that meets covered edges only
  int face = -1;           // of the first hull
  const Hull::Edge *ours = nullptr, *theirs = nullptr;
  Vector3d n{0, 0, 0};  // outwards from the first hull
};

/// A plane that comes to the hull along n, in its frame, meets this first.
enum class First { free, covered_face, covered_edges };
First first_of(const Hull& hull, const Vector3d& n) {
  constexpr double kOpposite = 1e-6;
  constexpr double kFirst = 1e-9;  // of the size
  if (!hull.any_covered) return First::free;
  for (const Hull::Face& face : hull.faces)
    if (face.normal.dot(n) < kOpposite - 1) return face.covered ? First::covered_face : First::free;
  double least = kInf;
  for (const Vector3d& corner : hull.corners) least = std::min(least, n.dot(corner));
  const auto first = [&](int i) {
    return n.dot(hull.corners[static_cast<std::size_t>(i)]) <= least + kFirst * hull.size;
  };
  bool corner_is_free = false;
  for (const Hull::Edge& edge : hull.edges) {
    const bool from = first(edge.from), to = first(edge.to), free = meets(edge, -n);
    if (from && to) return free ? First::free : First::covered_edges;
    corner_is_free = corner_is_free || ((from || to) && free);
  }
  return corner_is_free ? First::free : First::covered_edges;
}

/// The best face of `hull`; of `other` the corners in the same frame, into which R turns its own.
Axis best_face(const Hull& hull, const Hull& other, const Corners& others, const Matrix3d& R) {
  Axis best;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const Hull::Face& face = hull.faces[f];
    if (face.covered) continue;
    const First first = first_of(other, R.transpose() * face.normal);
    if (first == First::covered_face) continue;
    double least = kInf;
    for (std::size_t i = 0; i < other.corners.size(); ++i) least = std::min(least, face.normal.dot(others[i]));
    const double gap = least - face.offset;
    if (first == First::covered_edges)
      best.covered = std::max(best.covered, gap);
    else if (gap > best.gap)
      best.gap = gap, best.face = static_cast<int>(f);
  }
  return best;
}

/// The best product of two edges, in the frame of `a`; of b the corners, and R turns its frame into a's.
Axis best_edges(const Hull& a, const Hull& b, const Corners& b_corners, const Matrix3d& R) {
  Axis best;
  for (const Hull::Edge& theirs : b.edges) {
    if (theirs.covered) continue;
    const Vector3d& q = b_corners[static_cast<std::size_t>(theirs.from)];
    const Vector3d w = b_corners[static_cast<std::size_t>(theirs.to)] - q;
    const Vector3d left = R * theirs.left_normal, right = R * theirs.right_normal;
    for (const Hull::Edge& ours : a.edges) {
      if (ours.covered) continue;
      const Vector3d& p = a.corners[static_cast<std::size_t>(ours.from)];
      const Vector3d u = a.corners[static_cast<std::size_t>(ours.to)] - p;
      // The arcs of the two edges' normals on the sphere, one of them reversed, must cross.
      const double left_u = left.dot(u), right_u = right.dot(u);
      if (!(left_u * right_u < 0)) continue;
      const Vector3d &n_left = ours.left_normal, &n_right = ours.right_normal;
      const double left_w = n_left.dot(w), right_w = n_right.dot(w);
      if (!(left_w * right_w < 0) || !(left_u * right_w < 0)) continue;
      Vector3d n = u.cross(w);
      const double sine = n.norm();
      if (!(sine > kParallel * u.norm() * w.norm())) continue;
      n /= n.dot(n_left + n_right) < 0 ? -sine : sine;
      const double gap = n.dot(q - p);
      if (gap > best.gap) best = {gap, -kInf, -1, &ours, &theirs, n};
    }
  }
  return best;
}

/// The face of `other` that is turned to −n most, clipped to the sides of the face; all in the frame of `hull`.
std::size_t clipped(const Hull& hull, const Hull::Face& face, const Hull& other, const Corners& corners,
                    const Matrix3d& R, std::array<Vector3d, 2 * kMostHullPoints>& polygon) {
  const Vector3d n = R.transpose() * face.normal;
  const Hull::Face* facing = &other.faces.front();
  for (const Hull::Face& f : other.faces)
    if (f.normal.dot(n) < facing->normal.dot(n)) facing = &f;
  std::size_t count = 0;
  for (const int i : facing->corners) polygon[count++] = corners[static_cast<std::size_t>(i)];
  std::array<Vector3d, 2 * kMostHullPoints> next;
  for (std::size_t i = 0; i < face.corners.size() && count > 0; ++i) {
    const Vector3d& p = hull.corners[static_cast<std::size_t>(face.corners[i])];
    const Vector3d along = hull.corners[static_cast<std::size_t>(face.corners[(i + 1) % face.corners.size()])] - p;
    const Vector3d out = along.cross(face.normal).normalized();
    std::size_t kept = 0;
    const auto keep = [&](const Vector3d& x) {
      if (kept < next.size()) next[kept++] = x;
    };
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3d &x = polygon[k], &y = polygon[(k + 1) % count];
      const double at_x = out.dot(x - p), at_y = out.dot(y - p);
      if (at_x <= 0) keep(x);
      if ((at_x < 0 && at_y > 0) || (at_x > 0 && at_y < 0)) keep(x + at_x / (at_x - at_y) * (y - x));
    }
    polygon = next, count = kept;
  }
  return count;
}

/// Of the corners of the clipped face the deepest and those that span most with it: at most four.
void span(const std::array<Vector3d, 2 * kMostHullPoints>& polygon, std::size_t count, const Hull::Face& face,
          double same, TouchPoints& points) {
  const auto gap = [&](std::size_t i) { return face.normal.dot(polygon[i]) - face.offset; };
  const auto add = [&](std::size_t i) {
    const Vector3d& on_b = polygon[i];
    points.add({-face.normal, on_b - gap(i) * face.normal, on_b, gap(i)});
  };
  /// The one with the largest measure above a length.
  const auto take = [&](auto&& measure) {
    std::size_t best = count;
    double most = same;
    for (std::size_t i = 0; i < count; ++i)
      if (const double m = measure(polygon[i]); m > most) most = m, best = i;
    if (best < count) add(best);
    return best;
  };
  std::size_t first = 0;
  for (std::size_t i = 1; i < count; ++i)
    if (gap(i) < gap(first)) first = i;
  add(first);
  const Vector3d& p = polygon[first];
  const std::size_t second = take([&](const Vector3d& x) { return (x - p).norm(); });
  if (second == count) return;
  const Vector3d side = face.normal.cross(polygon[second] - p).normalized();
  take([&](const Vector3d& x) { return side.dot(x - p); });
  take([&](const Vector3d& x) { return -side.dot(x - p); });
}

/// Whether x is over the face, its edges included.
bool over(const Hull& hull, const Hull::Face& face, const Vector3d& x, double size) {
  for (std::size_t i = 0; i < face.corners.size(); ++i) {
    const Vector3d& p = hull.corners[static_cast<std::size_t>(face.corners[i])];
    const Vector3d along = hull.corners[static_cast<std::size_t>(face.corners[(i + 1) % face.corners.size()])] - p;
    if (along.cross(face.normal).dot(x - p) > kSamePoint * size * along.norm()) return false;
  }
  return true;
}

/// Whether one of the other's deepest corners is over the face of a hull with neighbours: no neighbour has that point
/// alone.
bool stands_on(const Hull& hull, int number, const Corners& others, const Hull& other, double size) {
  if (!hull.any_covered || number < 0) return false;
  const Hull::Face& face = hull.faces[static_cast<std::size_t>(number)];
  double least = kInf;
  for (std::size_t i = 0; i < other.corners.size(); ++i) least = std::min(least, face.normal.dot(others[i]));
  for (std::size_t i = 0; i < other.corners.size(); ++i)
    if (face.normal.dot(others[i]) <= least + kSamePoint * size && over(hull, face, others[i], size)) return true;
  return false;
}

/// Two polytopes whose frames differ by x → R x + d, b's into a's; the points in a's frame.
TouchPoints touch_hulls(const Hull& a, const Hull& b, const Matrix3d& R, const Vector3d& d) {
  TouchPoints points;
  Corners b_in_a, a_in_b;
  for (std::size_t i = 0; i < b.corners.size(); ++i) b_in_a[i] = R * b.corners[i] + d;
  for (std::size_t i = 0; i < a.corners.size(); ++i) a_in_b[i] = R.transpose() * (a.corners[i] - d);
  Matrix3d back;
  back.noalias() = R.transpose();
  const double size = std::min(a.size, b.size);
  const Axis face_a = best_face(a, b, b_in_a, R), face_b = best_face(b, a, a_in_b, back);
  const Axis edges = best_edges(a, b, b_in_a, R);
  const double faces = std::max(face_a.gap, face_b.gap);
  const bool of_b = face_b.gap > face_a.gap + kSameFace * size;
  if (std::max(face_a.covered, face_b.covered) > std::max(faces, edges.gap) &&
      !(faces > edges.gap &&
        stands_on(of_b ? b : a, of_b ? face_b.face : face_a.face, of_b ? a_in_b : b_in_a, of_b ? a : b, size)))
    return points;  // a neighbour is nearer
  if (edges.ours != nullptr && edges.gap > faces + kEdges * size) {
    const Vector3d& p = a.corners[static_cast<std::size_t>(edges.ours->from)];
    const Vector3d u = a.corners[static_cast<std::size_t>(edges.ours->to)] - p;
    const Vector3d& q = b_in_a[static_cast<std::size_t>(edges.theirs->from)];
    const Vector3d w = b_in_a[static_cast<std::size_t>(edges.theirs->to)] - q, r = p - q;
    const double uu = u.squaredNorm(), ww = w.squaredNorm(), uw = u.dot(w);
    const double s = (uw * w.dot(r) - ww * u.dot(r)) / (uu * ww - uw * uw);
    const Vector3d on_a = p + s * u;
    points.add({-edges.n, on_a, on_a + edges.gap * edges.n, edges.gap});
    return points;
  }
  if (faces == -kInf) return points;
  const Hull &hull = of_b ? b : a, &other = of_b ? a : b;
  const Corners& corners = of_b ? a_in_b : b_in_a;
  const Hull::Face& face = hull.faces[static_cast<std::size_t>(of_b ? face_b.face : face_a.face)];
  std::array<Vector3d, 2 * kMostHullPoints> polygon;
  std::size_t count = clipped(hull, face, other, corners, of_b ? back : R, polygon);
  // The deepest corner over the face may belong to another face than the clipped one. A corner outside of it is no
  // point of two faces that lie on each other: nothing is below it. Elsewhere it tells how deep the shapes overlap.
  const bool any = count > 0;
  std::size_t deepest = other.corners.size();
  double least = kInf;
  for (std::size_t i = 0; i < count; ++i) least = std::min(least, face.normal.dot(polygon[i]));
  const double below = least - kSamePoint * size, far_below = least - 2 * kSameFace * size;
  for (std::size_t i = 0; i < other.corners.size(); ++i) {
    const double height = face.normal.dot(corners[i]);
    if (height < std::min(least, below) && (!any || height < far_below || over(hull, face, corners[i], size)))
      deepest = i, least = height;
  }
  if (deepest < other.corners.size()) {
    count = std::min(count, polygon.size() - 1);
    polygon[count++] = corners[deepest];
  }
  span(polygon, count, face, kSamePoint * size, points);
  if (of_b)
    for (int i = 0; i < points.count; ++i) {
      TouchPoint& p = points.points[static_cast<std::size_t>(i)];
      p = swapped({R * p.n, R * p.on_a + d, R * p.on_b + d, p.gap});
    }
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
    points = touch_hulls(*a.hull, *b.hull, at_a.R.transpose() * at_b.R, at_a.turn_back(at_b.x - at_a.x));
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
