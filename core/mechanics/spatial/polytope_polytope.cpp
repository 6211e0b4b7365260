#include <orthant/core/mechanics/spatial/polytope_polytope.h>

#include <orthant/core/mechanics/spatial/polytope_side.h>

#include <algorithm>
#include <optional>

namespace orthant::spatial {
namespace {

constexpr double kSameFace = 1e-6;  // of the size: the face of b is taken only where it is better than a's by this
constexpr double kEdges = 1e-5;     // likewise edges instead of faces: shapes that lie on each other have four points

enum class Stand { here, past_a_seam, elsewhere };
/// Any axis, or those along which they stand on each other: two that are apart, or overlap; or faces at which
/// neighbours of the other come first, past seams.
enum class Ask { any, standing, standing_within, past_seams };

struct Axis {
  double gap = -kUnbounded;
  double blocked = -kUnbounded;  // the largest gap along a covered face or edge
  double passed = -kUnbounded;   // the largest gap along which they stand on each other past a seam only
  int face = -1;                 // of the side
  const Hull::Edge *ours = nullptr, *theirs = nullptr;
  Vector3d n{0, 0, 0};  // outwards from the side

  template <class Set> void take(double larger, Stand stand, Set&& set) {
    if (stand == Stand::past_a_seam) passed = std::max(passed, larger);
    if (stand == Stand::here) gap = larger, set();
  }
};

/// Whether x is past sides of the face, and all of them are of this kind.
template <class Kind> bool past_only(const Side& s, const Hull::Face& face, const Vector3d& x, Kind&& kind) {
  bool past = false, only = true;
  for (std::size_t i = 0; i < face.corners.size(); ++i) {
    const Vector3d& from = s.corner(face.corners[i]);
    const Vector3d out = (s.corner(face.corners[(i + 1) % face.corners.size()]) - from).cross(face.normal);
    if (out.dot(x - from) <= kSamePoint * s.size * out.norm()) continue;
    past = true, only = only && kind(s.hull.edges[static_cast<std::size_t>(face.edges[i])]);
  }
  return past && only;
}

/// Where what of the other is nearest to the plane of a face stands: on it (where they overlap: in the hull), or not.
Stand stand_of(const Side& s, const Hull::Face& face, double gap, Ask ask) {
  const double same = kSamePoint * s.size, most = face.offset + gap + same;
  const auto nearest = [&](const Vector3d& x) { return face.normal.dot(x) <= most; };
  const auto here = [&](const Vector3d& x) {
    return nearest(x) && (gap > 0 ? s.over(face, x) : s.hull.depth_of(x) <= same);
  };
  const Vector3d n = s.R.transpose() * face.normal;
  const auto goes_on_there = [&](const Hull::Edge& e) { return flush(e) || (ask == Ask::standing_within && e.step); };
  bool past = false;
  for (std::size_t i = 0; i < s.other.corners.size(); ++i) {
    const Vector3d& x = s.others[i];
    if (!nearest(x)) continue;
    if (here(x) || past_only(s, face, x, goes_on_there)) return Stand::here;
    past = past || goes_on(s.other, i, n) || s.hull.any_covered;
  }
  Clipped polygon;
  const std::size_t count = clipped(s, face, polygon);
  if (std::any_of(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(count), here)) return Stand::here;
  return past ? Stand::past_a_seam : Stand::elsewhere;
}

/// Whether neighbours of the other reach farther along a face's normal, in the flat surface that they make with the
/// other's facing face.
bool deeper_past_seam(const Side& s, const Hull::Face& face, double gap) {
  if (!s.other.any_covered || first_is_free(s.other, s.R.transpose() * face.normal)) return false;
  const Hull::Face& theirs = facing(s, face);
  if (theirs.covered) return false;
  const std::size_t count = theirs.corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double height = face.normal.dot(s.others_corner(theirs.corners[i])) - face.offset;
    const auto seam = [&](std::size_t k) {
      return flush(s.other.edges[static_cast<std::size_t>(theirs.edges[k % count])]);
    };
    if (height <= gap + kSamePoint * s.size && (seam(i) || seam(i + count - 1))) return true;
  }
  return false;
}

/// The face of the side with the largest gap, of those that `ask` admits.
Axis best_face(const Side& s, Ask ask) {
  Axis best;
  for (std::size_t f = 0; f < s.hull.faces.size(); ++f) {
    const Hull::Face& face = s.hull.faces[f];
    const double gap = s.gap(face);
    if (ask == Ask::past_seams) {
      if (gap > best.gap && !face.covered && deeper_past_seam(s, face, gap))
        best.gap = gap, best.face = static_cast<int>(f);
    } else if (face.covered || !first_is_free(s.other, s.R.transpose() * face.normal)) {
      best.blocked = std::max(best.blocked, gap);
    } else if (gap > best.gap) {
      best.take(gap, ask == Ask::any ? Stand::here : stand_of(s, face, gap, ask),
                [&] { best.face = static_cast<int>(f); });
    }
  }
  return best;
}

/// An edge of the side and one of the other, as lines p + s u and q + t w in the side's frame.
struct Lines {
  Vector3d p, u, q, w;
  Lines(const Side& side, const Hull::Edge& ours, const Hull::Edge& theirs)
      : p(side.corner(ours.from)),
        u(side.corner(ours.to) - p),
        q(side.others_corner(theirs.from)),
        w(side.others_corner(theirs.to) - q) {}
  /// s and t where the lines are nearest to each other.
  std::pair<double, double> nearest() const {
    const Vector3d r = p - q;
    const double uu = u.squaredNorm(), ww = w.squaredNorm(), uw = u.dot(w), square = uu * ww - uw * uw;
    return {(uw * w.dot(r) - ww * u.dot(r)) / square, (uu * w.dot(r) - uw * u.dot(r)) / square};
  }
  /// Whether that is on both edges.
  bool cross() const {
    const auto [s, t] = nearest();
    return within(s) && within(t);
  }
  /// Where they stand on each other along that axis: where they overlap, in both polytopes.
  Stand stand(const Side& side, const Hull::Edge& ours, const Hull::Edge& theirs, const Vector3d& n, double gap) const {
    const auto [s, t] = nearest();
    const double same = kSamePoint * side.size;
    if (within(s) && within(t))
      return gap > 0 || (side.hull.depth_of(q + t * w) <= same && side.other.depth_of(back(side, p + s * u)) <= same)
                 ? Stand::here
                 : Stand::elsewhere;
    if (within(t) == within(s)) return Stand::elsewhere;
    const auto end = [](const Hull::Edge& e, double at) { return static_cast<std::size_t>(at < 0 ? e.from : e.to); };
    const bool past =
        within(t) ? goes_on(side.hull, end(ours, s), -n) : goes_on(side.other, end(theirs, t), side.R.transpose() * n);
    return past ? Stand::past_a_seam : Stand::elsewhere;
  }

 private:
  static bool within(double s) { return s >= -kSamePoint && s <= 1 + kSamePoint; }
  static Vector3d back(const Side& side, const Vector3d& x) { return side.R.transpose() * (x - side.d); }
};

/// The product of two edges with the largest gap, in the side's frame, of those that `ask` admits.
Axis best_edges(const Side& side, Ask ask) {
  Axis best;
  const auto normal = [](const Hull& hull, int face) -> const Vector3d& {
    return hull.faces[static_cast<std::size_t>(face)].normal;
  };
  for (const Hull::Edge& theirs : side.other.edges) {
    const Vector3d& q = side.others_corner(theirs.from);
    const Vector3d w = side.others_corner(theirs.to) - q;
    const Vector3d left = side.R * normal(side.other, theirs.left), right = side.R * normal(side.other, theirs.right);
    for (const Hull::Edge& ours : side.hull.edges) {
      const Vector3d& p = side.corner(ours.from);
      const Vector3d u = side.corner(ours.to) - p;
      // The arcs of the two edges' normals on the sphere, one of them reversed, must cross.
      const double left_u = left.dot(u), right_u = right.dot(u);
      if (!(left_u * right_u < 0)) continue;
      const Vector3d &n_left = normal(side.hull, ours.left), &n_right = normal(side.hull, ours.right);
      const double left_w = n_left.dot(w), right_w = n_right.dot(w);
      if (!(left_w * right_w < 0) || !(left_u * right_w < 0)) continue;
      Vector3d n = u.cross(w);
      const double sine = n.norm();
      if (!(sine > kParallel * u.norm() * w.norm())) continue;
      n /= n.dot(n_left + n_right) < 0 ? -sine : sine;
      const double gap = n.dot(q - p);
      if (!ours.meets(n) || !theirs.meets(-(side.R.transpose() * n)))
        best.blocked = std::max(best.blocked, gap);
      else if (gap > best.gap)
        best.take(gap, ask == Ask::any ? Stand::here : Lines(side, ours, theirs).stand(side, ours, theirs, n, gap),
                  [&] { best.ours = &ours, best.theirs = &theirs, best.n = n; });
    }
  }
  return best;
}

struct Axes {
  Axis face_a, face_b, edges;
  double faces() const { return std::max(face_a.gap, face_b.gap); }
  double gap() const { return std::max(faces(), edges.gap); }
  double passed() const { return std::max({face_a.passed, face_b.passed, edges.passed}); }
  double blocked() const { return std::max({face_a.blocked, face_b.blocked, edges.blocked}); }
};
Axes best_axes(const Side& a, const Side& b, Ask ask) {
  return {best_face(a, ask), best_face(b, ask), best_edges(a, ask)};
}

/// Of the corners of the clipped face the deepest and those that span most with it: at most four.
void span(const Clipped& polygon, std::size_t count, const Hull::Face& face, double same, TouchPoints& points) {
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

/// Drops corners of a clipped face that only seams make: the neighbours' points span the contact there. Kept are those
/// where two lines cross that are no seams, and corners of either surface.
std::size_t without_seams(const Side& s, const Hull::Face& face, std::size_t count, Clipped& polygon) {
  const double same = kSamePoint * s.size;
  const Hull::Face& theirs = facing(s, face);
  const auto made_by_seams = [&](const Vector3d& x) {
    Vector3d line(0, 0, 0);  // that goes through x
    bool crossed = false;
    const auto look = [&](const Hull& hull, const Hull::Face& of, const Vector3d& n, auto&& at) {
      const std::size_t sides = of.corners.size();
      for (std::size_t i = 0; i < sides && !crossed; ++i) {
        const Vector3d p = at(of.corners[i]), along = (at(of.corners[(i + 1) % sides]) - p).normalized();
        const auto off = [&](const Vector3d& q) { return (x - q - n * n.dot(x - q)).norm(); };
        if (off(p) <= same && stays_corner(hull, of, i)) crossed = true;
        if (std::abs(along.cross(n).normalized().dot(x - p)) > same) continue;
        if (flush(hull.edges[static_cast<std::size_t>(of.edges[i])])) continue;
        crossed = crossed || line.cross(along).norm() > kParallel;
        line = along;
      }
    };
    look(s.hull, face, face.normal, [&](int i) { return s.corner(i); });
    look(s.other, theirs, s.R * theirs.normal, [&](int i) { return s.others_corner(i); });
    return !crossed;
  };
  const auto end = polygon.begin() + static_cast<std::ptrdiff_t>(count);
  return static_cast<std::size_t>(std::remove_if(polygon.begin(), end, made_by_seams) - polygon.begin());
}

/// Contact points on a face; none: neighbours have them. Without `outside` nothing where the other's nearest corner is
/// not over the face or, past seams, a neighbour's.
std::optional<TouchPoints> on_face(const Side& s, const Axis& axis, bool outside) {
  const Hull::Face& face = s.hull.faces[static_cast<std::size_t>(axis.face)];
  Clipped polygon;
  std::size_t count = clipped(s, face, polygon);
  // The deepest corner over the face may belong to another face than the clipped one.
  double least = kUnbounded;
  for (std::size_t i = 0; i < count; ++i) least = std::min(least, face.normal.dot(polygon[i]));
  const auto corners_of_other = static_cast<std::ptrdiff_t>(s.other.corners.size());
  std::size_t deepest = s.other.corners.size();
  const auto take_deepest = [&](double than, auto&& fits) {
    double best = std::min(least, than);
    for (std::size_t i = 0; i < s.other.corners.size(); ++i)
      if (const double height = face.normal.dot(s.others[i]); height < best && fits(s.others[i]))
        deepest = i, best = least = height;
  };
  take_deepest(least - kSamePoint * s.size, [&](const Vector3d& x) { return s.over(face, x); });
  // A corner that is not over the face has nothing below it: it is no point of two faces that lie on each other. Edges
  // that meet may be deeper than the part over the face by kEdges.
  // Past a seam in a flat surface a neighbour has that corner.
  TouchPoints points;
  const double nearest = face.offset + axis.gap, same = kSamePoint * s.size;
  const bool seams = s.hull.any_covered || s.other.any_covered;
  const auto in_hull = [&](const Vector3d& x) { return s.hull.depth_of(x) <= same; };
  const auto a_neighbours = [&](const Vector3d& x) {
    return face.normal.dot(x) <= nearest + same && past_only(s, face, x, flush) && !in_hull(x);
  };
  const bool past = seams && (deeper_past_seam(s, face, axis.gap) ||
                              std::any_of(s.others.begin(), s.others.begin() + corners_of_other, a_neighbours));
  if (!past && least > nearest + 2 * kEdges * s.size) {
    if (!outside) return {};
    take_deepest(kUnbounded, in_hull);
    if (least > nearest + 2 * kEdges * s.size) take_deepest(kUnbounded, [](const Vector3d& /*x*/) { return true; });
  }
  if (seams) {
    count = without_seams(s, face, count, polygon);
    least = kUnbounded;
    for (std::size_t i = 0; i < count; ++i) least = std::min(least, face.normal.dot(polygon[i]));
    if (!past && deepest == s.other.corners.size() && least > nearest + same)
      take_deepest(kUnbounded, [&](const Vector3d& x) { return in_hull(x) && !s.over(face, x); });
  }
  if (deepest < s.other.corners.size()) {
    count = std::min(count, polygon.size() - 1);
    polygon[count++] = s.others[deepest];
  }
  if (past) {  // what is below the surface, but not in the polytope, is in a neighbour
    const auto end = polygon.begin() + static_cast<std::ptrdiff_t>(count);
    const auto out = [&](const Vector3d& x) { return face.normal.dot(x) < face.offset && !in_hull(x); };
    count = static_cast<std::size_t>(std::remove_if(polygon.begin(), end, out) - polygon.begin());
  }
  if (count > 0) span(polygon, count, face, kSamePoint * s.size, points);
  return points;
}

/// Of two polytopes apart, in a's frame. None: at a covered face or edge. Nothing: so near that their distance has no
/// direction.
std::optional<TouchPoints> nearest_points(const Side& a, const Side& b) {
  double least = kUnbounded;
  TouchPoint best;
  const auto take = [&](const Vector3d& on_a, const Vector3d& on_b) {
    if (const double square = (on_a - on_b).squaredNorm(); square < least) least = square, best = {{}, on_a, on_b, 0};
  };
  const auto each_foot = [&](const Side& s, auto&& what) {
    for (const Hull::Face& face : s.hull.faces)
      for (std::size_t i = 0; i < s.other.corners.size(); ++i)
        if (const double height = face.normal.dot(s.others[i]) - face.offset;
            height > 0 && height * height < least && s.over(face, s.others[i]))
          what(Vector3d(s.others[i] - height * face.normal), s.others[i]);
  };
  each_foot(a, take);
  each_foot(b, [&](const Vector3d& on_b, const Vector3d& on_a) { take(a.R * on_a + a.d, a.R * on_b + a.d); });
  for (const Hull::Edge& ours : a.hull.edges)
    for (const Hull::Edge& theirs : b.hull.edges) {
      const Segment x{a.corner(ours.from), a.corner(ours.to)},
          y{a.others_corner(theirs.from), a.others_corner(theirs.to)};
      const auto [s, t] = nearest(x, y);
      take(x.at(s), y.at(t));
    }
  TouchPoints points;
  if (least <= kSamePoint * kSamePoint * a.size * a.size) return {};
  best = grown(best.on_a, 0, best.on_b, 0);
  if (first_is_free(a.hull, best.n) && first_is_free(b.hull, -(a.R.transpose() * best.n))) points.add(best);
  return points;
}

/// The points along the best of these axes, in a's frame. Nothing: along that axis neither stands on the other, and
/// `outside` is false.
std::optional<TouchPoints> points_of(const Side& a, const Side& b, const Axes& axes, bool outside) {
  if (const Axis& edges = axes.edges; edges.ours != nullptr && edges.gap > axes.faces() + kEdges * a.size) {
    const Lines lines(a, *edges.ours, *edges.theirs);
    if (!outside && !lines.cross()) return {};
    const Segment x{lines.p, lines.p + lines.u}, y{lines.q, lines.q + lines.w};
    const Vector3d on_a = x.at(nearest(x, y).first);  // on the edge where they are almost parallel, too
    TouchPoints points;
    points.add({-edges.n, on_a, on_a + edges.gap * edges.n, edges.gap});
    return points;
  }
  if (axes.face_b.gap <= axes.face_a.gap + kSameFace * a.size) return on_face(a, axes.face_a, outside);
  std::optional<TouchPoints> points = on_face(b, axes.face_b, outside);
  for (int i = 0; points && i < points->count; ++i) {
    TouchPoint& p = points->points[static_cast<std::size_t>(i)];
    p = {-(a.R * p.n), a.R * p.on_b + a.d, a.R * p.on_a + a.d, p.gap};
  }
  return points;
}

double least_gap(const TouchPoints& points) {
  double least = kUnbounded;
  for (int i = 0; i < points.count; ++i) least = std::min(least, points.points[static_cast<std::size_t>(i)].gap);
  return least;
}

}  // namespace

TouchPoints touch_polytopes(const Hull& a, const Hull& b, const Matrix3d& R, const Vector3d& d) {
  const double size = std::min(a.size, b.size);
  Side of_a{a, b, {}, R, d, size}, of_b{b, a, {}, R.transpose(), -(R.transpose() * d), size};
  for (std::size_t i = 0; i < b.corners.size(); ++i) of_a.others[i] = R * b.corners[i] + d;
  for (std::size_t i = 0; i < a.corners.size(); ++i) of_b.others[i] = R.transpose() * (a.corners[i] - d);
  Axes axes = best_axes(of_a, of_b, Ask::any);
  const double blocked = axes.blocked(), most = std::max(blocked, axes.gap());
  if (axes.gap() > -kUnbounded && blocked <= axes.gap() + (blocked > 0 ? 0 : kSameFace * size)) {
    if (const auto points = points_of(of_a, of_b, axes, false)) return *points;
    if (axes.gap() > 0)
      if (const auto points = nearest_points(of_a, of_b)) return *points;
    const Axes standing = best_axes(of_a, of_b, Ask::standing_within);
    if (standing.gap() > axes.gap() - kEdges * size)
      if (const auto points = points_of(of_a, of_b, standing, true); points->count > 0) return *points;
    if (blocked < axes.gap() - kSameFace * size) return *points_of(of_a, of_b, axes, true);
  }
  axes = best_axes(of_a, of_b, blocked > 0 ? Ask::standing : Ask::standing_within);
  TouchPoints points;
  if (axes.gap() > -kUnbounded && axes.passed() <= axes.gap() + kSameFace * size)
    points = *points_of(of_a, of_b, axes, true);
  if (points.count > 0 && least_gap(points) >= -size / 2) return points;
  // Deeper there is no telling which way is out.
  axes = {best_face(of_a, Ask::past_seams), best_face(of_b, Ask::past_seams), {}};
  constexpr double kDeeper = 4;
  if (axes.gap() == -kUnbounded || axes.gap() < (most > 0 ? 0 : kDeeper * most) - kSameFace * size) return {};
  return *points_of(of_a, of_b, axes, true);
}

}  // namespace orthant::spatial
