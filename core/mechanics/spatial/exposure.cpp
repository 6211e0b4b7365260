#include <orthant/core/mechanics/spatial/exposure.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace orthant::spatial {
namespace {

constexpr double kOnFace = 1e-9;                     // of the size
constexpr double kSmooth = 1e-6;                     // sine of the tilt of two faces that are one surface
constexpr double kSteep = 0.7;                       // sine of the rise of a step
constexpr double kAgainst = 1e-6;                    // 1 + cosine of two faces that lie against each other
constexpr double kPlaces[] = {0.5, 1e-3, 1 - 1e-3};  // of an edge

struct HullBox {
  Vector3d low, high;
  explicit HullBox(const Hull& hull) : low(hull.corners.front()), high(low) {
    for (const Vector3d& corner : hull.corners) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
    low.array() -= kOnFace * hull.size, high.array() += kOnFace * hull.size;
  }
  bool meets(const HullBox& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

const Vector3d& corner_of(const Hull& hull, int i) { return hull.corners[static_cast<std::size_t>(i)]; }
const Hull::Face& face_of(const Hull& hull, int i) { return hull.faces[static_cast<std::size_t>(i)]; }

using Rim = std::vector<Vector3d>;  // corners of a convex polygon, in order

/// The part of a polygon with n · x ≥ offset.
Rim beyond(const Rim& rim, const Vector3d& n, double offset) {
  Rim kept;
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Vector3d &x = rim[i], &y = rim[(i + 1) % rim.size()];
    const double at_x = n.dot(x) - offset, at_y = n.dot(y) - offset;
    if (at_x >= 0) kept.push_back(x);
    if ((at_x < 0 && at_y > 0) || (at_x > 0 && at_y < 0)) kept.push_back(x + at_x / (at_x - at_y) * (y - x));
  }
  return kept;
}

/// The parts of polygons that are not in or on a polytope.
void leave(std::vector<Rim>& parts, const Hull& hull, double most) {
  std::vector<Rim> left;
  for (Rim& part : parts) {
    const bool off = std::any_of(hull.faces.begin(), hull.faces.end(), [&](const Hull::Face& face) {
      return std::all_of(part.begin(), part.end(),
                         [&](const Vector3d& p) { return face.normal.dot(p) - face.offset >= most; });
    });
    if (off) {
      left.push_back(std::move(part));
      continue;
    }
    for (const Hull::Face& face : hull.faces) {
      if (Rim out = beyond(part, face.normal, face.offset + most); out.size() > 2) left.push_back(std::move(out));
      part = beyond(part, -face.normal, -(face.offset + most));
    }
  }
  parts.swap(left);
}

/// Marks the faces of `hull` that lie in or on the others with all of their area, and the edges of these.
void cover(Hull& hull, std::span<Hull* const> hulls, const std::vector<std::size_t>& others) {
  for (Hull::Face& one : hull.faces) {
    std::vector<Rim> parts(1);
    for (const int i : one.corners) parts.front().push_back(corner_of(hull, i));
    for (const std::size_t other : others)
      if (!parts.empty()) leave(parts, *hulls[other], kOnFace * hull.size);
    if (!parts.empty()) continue;
    one.covered = hull.any_covered = true;
    for (const int e : one.edges) hull.edges[static_cast<std::size_t>(e)].covered = true;
  }
}

/// Whether p lies on the face.
bool lies_on(const Hull& hull, const Hull::Face& on, const Vector3d& p, double most) {
  if (std::abs(on.normal.dot(p) - on.offset) > most) return false;
  for (std::size_t i = 0; i < on.corners.size(); ++i) {
    const Vector3d& from = corner_of(hull, on.corners[i]);
    const Vector3d along = corner_of(hull, on.corners[(i + 1) % on.corners.size()]) - from;
    if (along.cross(on.normal).normalized().dot(p - from) > most) return false;
  }
  return true;
}

/// The covered edge e of `hull` is a ridge where it borders on a free face of `other` that falls, a step where that
/// face rises steeply.
void find_ridge(const Hull& hull, Hull::Edge& e, const Hull& other) {
  const bool left_is_free = !face_of(hull, e.left).covered;
  const Hull::Face &own = face_of(hull, left_is_free ? e.left : e.right),
                   &hidden = face_of(hull, left_is_free ? e.right : e.left);
  const Vector3d &from = corner_of(hull, e.from), &to = corner_of(hull, e.to), along = (to - from).normalized();
  const double most = kOnFace * std::max(hull.size, other.size);
  for (const Hull::Face& theirs : other.faces) {
    if (theirs.covered) continue;
    // Several neighbours may share the edge.
    if (std::none_of(std::begin(kPlaces), std::end(kPlaces),
                     [&](double place) { return lies_on(other, theirs, from + place * (to - from), most); }))
      continue;
    Vector3d away(0, 0, 0);
    for (const int i : theirs.corners) away += corner_of(other, i) - from;
    away = (away - along * along.dot(away)).normalized();
    const bool against = theirs.normal.dot(hidden.normal) < kAgainst - 1;  // it goes down from the edge, too
    e.step = e.step || own.normal.dot(away) > kSteep ||
             (against && std::any_of(theirs.corners.begin(), theirs.corners.end(), [&](int i) {
                return own.normal.dot(corner_of(other, i) - from) > kSmooth * other.size;
              }));
    if (against || !(own.normal.dot(away) < -kSmooth)) continue;
    e.covered = false, e.beyond = away;
    (left_is_free ? e.right_normal : e.left_normal) = theirs.normal;
    return;
  }
}

/// The part of the segment from p to p + side that lies on a face: from `low` to `high`, 0 at p and 1 at its end.
std::pair<double, double> part_on(const Hull& hull, const Hull::Face& face, const Vector3d& p, const Vector3d& side,
                                  double most) {
  double low = 0, high = 1;
  for (std::size_t i = 0; i < face.corners.size(); ++i) {
    const Vector3d& q = corner_of(hull, face.corners[i]);
    const Vector3d along = corner_of(hull, face.corners[(i + 1) % face.corners.size()]) - q;
    const Vector3d out = along.cross(face.normal).normalized();
    const double at = out.dot(p - q) - most, rate = out.dot(side);
    if (std::abs(rate) > most)
      (rate > 0 ? high : low) = rate > 0 ? std::min(high, -at / rate) : std::max(low, -at / rate);
    else if (at > 0)
      return {1, 0};
  }
  return {low, high};
}

/// A covered edge in a flat surface: sets its direction `beyond` where free faces of neighbours go on in the plane of
/// its own face along all of it.
void find_flush(const Hull& hull, Hull::Edge& e, std::span<Hull* const> hulls, const std::vector<std::size_t>& others) {
  const Hull::Face& own = face_of(hull, face_of(hull, e.left).covered ? e.right : e.left);
  const Vector3d& from = corner_of(hull, e.from);
  const Vector3d side = corner_of(hull, e.to) - from;
  Vector3d away(0, 0, 0);
  for (const int i : own.corners) away -= corner_of(hull, i) - from;
  away = (away - side * (side.dot(away) / side.squaredNorm())).normalized();
  std::vector<std::pair<double, double>> parts;
  for (const std::size_t j : others) {
    const Hull& other = *hulls[j];
    const double most = kOnFace * std::max(hull.size, other.size);
    for (const Hull::Face& theirs : other.faces) {
      const auto on_plane = [&](const Vector3d& p) { return std::abs(theirs.normal.dot(p) - theirs.offset) <= most; };
      const auto past = [&](int i) { return away.dot(corner_of(other, i) - from) > most; };
      if (theirs.covered || (theirs.normal - own.normal).norm() > kSmooth || !on_plane(from) ||
          !on_plane(from + side) || std::none_of(theirs.corners.begin(), theirs.corners.end(), past))
        continue;
      if (const auto part = part_on(other, theirs, from, side, most); part.first < part.second) parts.push_back(part);
    }
  }
  std::sort(parts.begin(), parts.end());
  double reached = 0;
  for (const auto& [low, high] : parts)
    if (low <= reached + kOnFace) reached = std::max(reached, high);
  if (reached >= 1 - kOnFace) e.beyond = away;
}

/// Adds the directions along which another polytope reaches from the corners of `hull`: those of its edges there, or,
/// at a point that is no corner of it, those to its corners.
void find_ways(Hull& hull, const Hull& other) {
  constexpr double kSame = 1e-9;  // between unit vectors
  const double most = kOnFace * std::max(hull.size, other.size);
  hull.ways.resize(hull.corners.size());
  for (std::size_t i = 0; i < hull.corners.size(); ++i) {
    const Vector3d& p = hull.corners[i];
    if (other.depth_of(p) > most) continue;
    const auto add = [&](const Vector3d& to) {
      const Vector3d way = (to - p).normalized();
      std::vector<Vector3d>& ways = hull.ways[i];
      if (std::none_of(ways.begin(), ways.end(), [&](const Vector3d& one) { return (one - way).norm() < kSame; }))
        ways.push_back(way);
    };
    const auto same = std::find_if(other.corners.begin(), other.corners.end(),
                                   [&](const Vector3d& q) { return (q - p).norm() <= 2 * most; });
    if (same == other.corners.end()) {
      for (const Vector3d& q : other.corners) add(q);
      continue;
    }
    const auto number = static_cast<int>(same - other.corners.begin());
    for (const Hull::Edge& e : other.edges)
      if (e.from == number || e.to == number) add(corner_of(other, e.from == number ? e.to : e.from));
  }
}

/// Of each polytope the others whose boxes meet its own, ascending.
std::vector<std::vector<std::size_t>> neighbours_of(std::span<Hull* const> hulls) {
  std::vector<HullBox> boxes;
  for (const Hull* hull : hulls) boxes.emplace_back(*hull);
  std::vector<std::size_t> order(hulls.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return boxes[i].low.x() < boxes[j].low.x(); });
  std::vector<std::vector<std::size_t>> near(hulls.size());
  for (auto i = order.begin(); i != order.end(); ++i)
    for (auto j = i + 1; j != order.end() && boxes[*j].low.x() <= boxes[*i].high.x(); ++j)
      if (boxes[*i].meets(boxes[*j])) near[*i].push_back(*j), near[*j].push_back(*i);
  for (std::vector<std::size_t>& all : near) std::sort(all.begin(), all.end());
  return near;
}

}  // namespace

void expose(std::span<Hull* const> hulls) {
  const auto near = neighbours_of(hulls);
  for (std::size_t i = 0; i < hulls.size(); ++i) cover(*hulls[i], hulls, near[i]);
  for (std::size_t i = 0; i < hulls.size(); ++i)
    for (Hull::Edge& e : hulls[i]->edges)
      if (e.covered && face_of(*hulls[i], e.left).covered != face_of(*hulls[i], e.right).covered)
        for (const std::size_t j : near[i])
          if (e.covered) find_ridge(*hulls[i], e, *hulls[j]);
  for (std::size_t i = 0; i < hulls.size(); ++i)
    for (Hull::Edge& e : hulls[i]->edges)
      if (e.covered && !e.step && face_of(*hulls[i], e.left).covered != face_of(*hulls[i], e.right).covered)
        find_flush(*hulls[i], e, hulls, near[i]);
  for (std::size_t i = 0; i < hulls.size(); ++i)
    if (hulls[i]->any_covered)
      for (const std::size_t j : near[i]) find_ways(*hulls[i], *hulls[j]);
}

bool first_is_free(const Hull& hull, const Vector3d& n) {
  constexpr double kOpposite = 1e-9;  // of the difference of unit vectors
  constexpr double kFirst = 1e-9;     // of the size
  if (!hull.any_covered) return true;
  for (const Hull::Face& face : hull.faces)
    if ((face.normal + n).norm() < kOpposite) return !face.covered;
  constexpr double kBehind = 1e-9;  // cosine
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3d& corner : hull.corners) least = std::min(least, n.dot(corner));
  const auto first = [&](int i) {
    return n.dot(hull.corners[static_cast<std::size_t>(i)]) <= least + kFirst * hull.size;
  };
  for (const Hull::Edge& edge : hull.edges)
    if (first(edge.from) && first(edge.to)) return edge.meets(-n);
  for (std::size_t i = 0; i < hull.ways.size(); ++i)
    if (first(static_cast<int>(i)))
      return std::none_of(hull.ways[i].begin(), hull.ways[i].end(),
                          [&](const Vector3d& way) { return n.dot(way) < -kBehind; });
  return true;
}

bool goes_on(const Hull& hull, std::size_t corner, const Vector3d& n) {
  constexpr double kFlush = 1e-6;  // cosine
  if (hull.ways.empty()) return false;
  const std::vector<Vector3d>& ways = hull.ways[corner];
  return std::any_of(ways.begin(), ways.end(), [&](const Vector3d& way) { return std::abs(n.dot(way)) <= kFlush; });
}

bool stays_corner(const Hull& hull, const Hull::Face& face, std::size_t k) {
  constexpr double kFlush = 1e-6;  // cosine, sine
  const std::size_t count = face.corners.size();
  const auto at = [&](std::size_t i) -> const Vector3d& {
    return hull.corners[static_cast<std::size_t>(face.corners[i % count])];
  };
  const std::array<Vector3d, 2> own{(at(k + 1) - at(k)).normalized(), (at(k + count - 1) - at(k)).normalized()};
  const auto corner = static_cast<std::size_t>(face.corners[k]);
  const auto all_left_of = [&](const Vector3d& d) {
    const auto left = [&](const Vector3d& w) {
      const double sine = face.normal.dot(d.cross(w));
      return std::abs(face.normal.dot(w)) > kFlush || sine > kFlush || (sine >= -kFlush && d.dot(w) > 0);
    };
    return std::all_of(own.begin(), own.end(), left) &&
           (hull.ways.empty() || std::all_of(hull.ways[corner].begin(), hull.ways[corner].end(), left));
  };
  if (std::any_of(own.begin(), own.end(), all_left_of)) return true;
  return !hull.ways.empty() && std::any_of(hull.ways[corner].begin(), hull.ways[corner].end(), [&](const Vector3d& d) {
    return std::abs(face.normal.dot(d)) <= kFlush && all_left_of(d);
  });
}

}  // namespace orthant::spatial
