#include <orthant/core/mechanics/spatial/round_polytope.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant::spatial {
namespace {

constexpr double kLargest = std::numeric_limits<double>::infinity();

const Vector3d& corner_at(const Hull& hull, int i) { return hull.corners[static_cast<std::size_t>(i)]; }
const Hull::Edge& edge_at(const Hull& hull, int i) { return hull.edges[static_cast<std::size_t>(i)]; }
Segment line_of(const Hull& hull, const Hull::Edge& e) { return {corner_at(hull, e.from), corner_at(hull, e.to)}; }
double height_over(const Hull::Face& face, const Vector3d& x) { return face.normal.dot(x) - face.offset; }

/// A point grown by a radius; false: nothing of the polytope can be touched from there.
bool touch_point(const Vector3d& p, double radius, const Hull& hull, TouchPoint& result) {
  double deepest = -kLargest, least = kLargest;
  const Hull::Face* face_of = nullptr;
  Vector3d nearest_point(0, 0, 0);
  bool covered = false;
  for (const Hull::Face& face : hull.faces) {
    const double height = height_over(face, p);
    if (!face.covered && height > deepest) deepest = height, face_of = &face;
    if (!(height > 0)) continue;
    Vector3d on = p - height * face.normal;
    bool off = face.covered, within = true;
    double nearest_edge = kLargest;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const Segment side{corner_at(hull, face.corners[i]),
                         corner_at(hull, face.corners[(i + 1) % face.corners.size()])};
      if (face.normal.dot((side.q - side.p).cross(p - side.p)) >= 0) continue;
      within = false;
      const Vector3d candidate = side.at(side.nearest(p));
      const double away = (p - candidate).squaredNorm();
      if (away < nearest_edge || (away == nearest_edge && off))
        nearest_edge = away, on = candidate, off = !edge_at(hull, face.edges[i]).meets(p - on);
    }
    const double away = within ? height * height : nearest_edge;
    if (away < least || (away == least && covered)) least = away, nearest_point = on, covered = off;
  }
  if (least < kLargest) {
    result = grown(p, radius, nearest_point, 0);
    return !covered;
  }
  if (face_of == nullptr) return false;
  result = {face_of->normal, p - radius * face_of->normal, p - deepest * face_of->normal, deepest - radius};
  return true;
}

/// The part of a core from s = `from` to `to`, and the edges of a face that end it.
struct CorePart {
  double from = 0, to = 1;
  const Hull::Edge *from_edge = nullptr, *to_edge = nullptr;

  bool empty() const { return !(from <= to); }
  /// Cuts off where a value that is linear along the core, given at both ends, is > 0.
  void cut(double at_p, double at_q, const Hull::Edge* edge = nullptr) {
    if (at_p > 0 && at_q > 0) from = 1, to = 0;
    if ((at_p > 0) == (at_q > 0)) return;
    const double s = at_p / (at_p - at_q);
    if (at_p > 0 && s > from) from = s, from_edge = edge;
    if (at_q > 0 && s < to) to = s, to_edge = edge;
  }
  struct End {
    double s;
    const Hull::Edge* edge;
  };
  End farther(double s) const {
    return std::abs(from - s) > std::abs(to - s) ? End{from, from_edge} : End{to, to_edge};
  }
};

/// Within the faces that `which` admits, extended.
template <class Which> CorePart part_within(const Segment& core, const Hull& hull, Which&& which) {
  CorePart part;
  for (const Hull::Face& face : hull.faces)
    if (which(face)) part.cut(height_over(face, core.p), height_over(face, core.q));
  return part;
}

/// Over or under a face.
CorePart part_over(const Segment& core, const Hull& hull, const Hull::Face& face) {
  CorePart part;
  for (std::size_t i = 0; i < face.corners.size(); ++i) {
    const Vector3d& from = corner_at(hull, face.corners[i]);
    const Vector3d out = (corner_at(hull, face.corners[(i + 1) % face.corners.size()]) - from).cross(face.normal);
    part.cut(out.dot(core.p - from), out.dot(core.q - from), &edge_at(hull, face.edges[i]));
  }
  return part;
}

/// Between the planes through an edge's ends, square to it.
CorePart part_along(const Segment& core, const Segment& edge) {
  CorePart part;
  const Vector3d along = edge.q - edge.p;
  part.cut(along.dot(edge.p - core.p), along.dot(edge.p - core.q));
  part.cut(along.dot(core.p - edge.q), along.dot(core.q - edge.q));
  return part;
}

const Hull::Face* face_along(const Hull& hull, const Vector3d& n) {
  const Hull::Face* best = nullptr;
  for (const Hull::Face& face : hull.faces)
    if (!face.covered && (best == nullptr || face.normal.dot(n) > best->normal.dot(n))) best = &face;
  return best;
}

/// Of the free edges through a point the one that is most parallel to a direction.
const Hull::Edge* edge_along(const Hull& hull, const Vector3d& x, const Vector3d& u) {
  const Hull::Edge* best = nullptr;
  double most = -1;
  for (const Hull::Edge& e : hull.edges) {
    const Segment line = line_of(hull, e);
    if (e.covered || (line.at(line.nearest(x)) - x).norm() > kSamePoint * hull.size) continue;
    if (const double cosine = std::abs(u.dot((line.q - line.p).normalized())); cosine > most) most = cosine, best = &e;
  }
  return best;
}

/// Whether neighbours go on from an end of an edge, straight on.
bool straight_on(const Hull& hull, const Hull::Edge& e, bool last) {
  constexpr double kStraight = 1e-9;  // of the difference of unit vectors
  if (hull.ways.empty()) return false;
  const Segment line = line_of(hull, e);
  const Vector3d out = (last ? 1 : -1) * (line.q - line.p).normalized();
  const auto& ways = hull.ways[static_cast<std::size_t>(last ? e.to : e.from)];
  return std::any_of(ways.begin(), ways.end(), [&](const Vector3d& way) { return (way - out).norm() < kStraight; });
}

bool in_interior(double s) { return s > 0 && s < 1; }

class Candidates {
 public:
  explicit Candidates(double same) : same_(same) {}
  void add(const TouchPoint& p) { points_[count_++] = p; }
  TouchPoints sorted() {
    TouchPoints points;
    add_sorted(points_, count_, same_, points);
    return points;
  }

 private:
  double same_;
  std::size_t count_ = 0;
  std::array<TouchPoint, 8> points_;
};

/// A core outside of the polytope. False: so near that the distance has no direction.
bool touch_outside(const Segment& core, double radius, const Hull& hull, Candidates& found) {
  double least = kLargest, s_least = 0;
  TouchPoint nearest_of_all;
  const auto at_end = [&](double s) {
    TouchPoint p;
    if (touch_point(core.at(s), radius, hull, p)) found.add(p);
    if (const double away = p.gap + radius; away < least) least = away, s_least = s, nearest_of_all = p;
  };
  at_end(0), at_end(1);
  for (const Hull::Edge& e : hull.edges) {
    const Segment edge = line_of(hull, e);
    const auto [s, t] = nearest(core, edge);
    if (const double away = (core.at(s) - edge.at(t)).norm(); in_interior(s) && away < least) least = away, s_least = s;
  }
  if (least <= kSamePoint * hull.size) return false;
  if (in_interior(s_least) && touch_point(core.at(s_least), radius, hull, nearest_of_all)) found.add(nearest_of_all);
  const auto add_at = [&](double s) {
    if (TouchPoint p; in_interior(s) && touch_point(core.at(s), radius, hull, p)) found.add(p);
  };
  const Vector3d n = nearest_of_all.n, on = nearest_of_all.on_b;
  if (const Hull::Face* face = face_along(hull, n); face != nullptr)
    if (const CorePart part = part_over(core, hull, *face); !part.empty())
      if (const CorePart::End far = part.farther(s_least); far.edge == nullptr || !far.edge->covered) add_at(far.s);
  if (const Hull::Edge* e = edge_along(hull, on, core.q - core.p); e != nullptr) {
    const Segment edge = line_of(hull, *e);
    if (const CorePart part = part_along(core, edge); !part.empty()) {
      const double s = part.farther(s_least).s;
      if (!straight_on(hull, *e, edge.nearest(core.at(s)) > 0.5)) add_at(s);
    }
  }
  return true;
}

/// The axis along which a core and the polytope overlap least, of those that can be touched.
struct LeastOverlap {
  double gap = -kLargest;
  double s = 0;  // on the core
  Vector3d n{0, 0, 0};
};
LeastOverlap least_overlap(const Segment& core, const Hull& hull) {
  LeastOverlap best;
  const Vector3d u = core.q - core.p;
  for (const Hull::Face& face : hull.faces) {
    if (face.covered) continue;
    const double at_p = height_over(face, core.p), at_q = height_over(face, core.q);
    if (const double gap = std::min(at_p, at_q); gap > best.gap) best = {gap, at_p <= at_q ? 0.0 : 1.0, face.normal};
  }
  for (const Hull::Edge& e : hull.edges) {
    if (e.covered || !(e.left_normal.dot(u) * e.right_normal.dot(u) < 0)) continue;
    const Segment edge = line_of(hull, e);
    const Vector3d w = edge.q - edge.p;
    Vector3d n = u.cross(w);
    const double sine = n.norm();
    if (!(sine > kParallel * u.norm() * w.norm())) continue;
    n /= n.dot(e.left_normal + e.right_normal) < 0 ? -sine : sine;
    const double gap = n.dot(core.p - edge.p);
    if (!(gap > best.gap) || !e.meets(n)) continue;
    const auto [s, t] = nearest(core, edge);
    if (hull.any_covered && !(in_interior(s) && in_interior(t))) continue;  // past it there are neighbours
    best = {gap, s, n};
  }
  return best;
}

/// A core through the polytope.
void touch_through(const Segment& whole, double radius, const Hull& hull, Candidates& found) {
  const CorePart own = part_within(whole, hull, [](const Hull::Face& face) { return face.covered; });
  if (own.empty()) return;
  const Segment core{whole.at(own.from), whole.at(own.to)};  // the rest is with neighbours
  const LeastOverlap least = least_overlap(core, hull);
  if (least.gap == -kLargest) return;
  const auto add = [&](double s, const Vector3d& n, double height) {
    const Vector3d x = core.at(s);
    found.add({n, x - radius * n, x - height * n, height - radius});
  };
  add(least.s, least.n, least.gap);
  const Hull::Face* face = face_along(hull, least.n);
  if (face == nullptr) return;
  const CorePart part = part_over(core, hull, *face);
  if (part.empty()) return;
  const double s = part.farther(least.s).s, height = height_over(*face, core.at(s));
  if (height >= least.gap && s != least.s) add(s, face->normal, height);  // deeper: the core does not lie along it
}

}  // namespace

TouchPoints touch_core(const Segment& core, double radius, const Hull& hull) {
  Candidates found(kSamePoint * hull.size);
  if (core.p == core.q) {
    if (TouchPoint p; touch_point(core.p, radius, hull, p)) found.add(p);
    return found.sorted();
  }
  const bool through = !part_within(core, hull, [](const Hull::Face& /*f*/) { return true; }).empty();
  if (through || !touch_outside(core, radius, hull, found)) {
    found = Candidates(kSamePoint * hull.size);
    touch_through(core, radius, hull, found);
  }
  return found.sorted();
}

}  // namespace orthant::spatial
