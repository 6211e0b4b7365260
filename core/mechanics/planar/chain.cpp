#include <orthant/core/mechanics/planar/chain.h>
#include <orthant/core/mechanics/planar/contact_sets.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace orthant {
namespace {

constexpr double kInLine = 1e-9;        // sine of a joint's angle that is none
constexpr double kStraightBack = 1e-3;  // likewise: of the sharpest spike
constexpr double kMitre = 3;            // of the depth: the longest bisector of a strip
constexpr int kHalvings = 60;           // of the depth, until the strip counts as having no room
constexpr double kBent = 0.1;           // sine of an inner corner's bend behind which segments go on
constexpr double kGoesOn = 16;          // part of the strip's slant by which it does
constexpr double kBehind = 1e-3;        // of the depth: how far an end that goes on is behind the neighbour's faces
constexpr double kAway = 0.2;           // sine of the angle between that end and the neighbour's back

std::string point_name(std::size_t i) { return "points[" + std::to_string(i) + "]"; }

/// A point of the chain: the free side is on the right of the way along them.
struct Knot {
  std::size_t place;             // in GroundChain::points
  Vector2d point, inward{0, 0};  // inward · depth leads to the strip's back
  double depth = 0;
};

Vector2d way(const Knot& from, const Knot& to) { return (to.point - from.point).normalized(); }

bool inside(const Polygon& p, const Vector2d& point, double by) {
  for (std::size_t k = 0; k < p.size(); ++k)
    if (outward(p, k).dot(point - p[k]) > -by) return false;
  return true;
}

/// Whether the segments p–q and r–s have a point in common, ends included, and are not in one line.
bool cross_each_other(const Vector2d& p, const Vector2d& q, const Vector2d& r, const Vector2d& s) {
  const double r_side = cross(q - p, r - p), s_side = cross(q - p, s - p), p_side = cross(s - r, p - r),
               q_side = cross(s - r, q - r);
  return r_side * s_side <= 0 && p_side * q_side <= 0 && !(r_side == 0 && s_side == 0);
}

std::vector<Knot> knots_of(const GroundChain& chain) {
  const auto& points = chain.points;
  if (points.size() < (chain.closed ? 3u : 2u))
    throw std::invalid_argument("points (" + std::to_string(points.size()) + "): must be at least " +
                                (chain.closed ? "three of a closed chain" : "two"));
  std::vector<Knot> all;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t place = chain.free_left ? points.size() - 1 - i : i;
    if (!points[place].allFinite()) throw std::invalid_argument(point_name(place) + ": must be finite");
    all.push_back({place, points[place]});
  }
  const std::size_t n = all.size();
  for (std::size_t i = 0; i + 1 < n || (chain.closed && i < n); ++i)
    if (all[i].point == all[(i + 1) % n].point)
      throw std::invalid_argument(point_name(std::max(all[i].place, all[(i + 1) % n].place)) +
                                  ": must differ from the point before" +
                                  (i + 1 == n ? " (a closed chain returns to its first point by itself)" : ""));
  std::vector<Knot> kept;
  for (std::size_t i = 0; i < n; ++i) {
    const bool end = !chain.closed && (i == 0 || i + 1 == n);
    if (!end) {
      const Vector2d in = way(all[(i + n - 1) % n], all[i]), out = way(all[i], all[(i + 1) % n]);
      if (in.dot(out) < 0 && std::abs(cross(in, out)) <= kStraightBack)
        throw std::invalid_argument(point_name(all[i].place) + ": the chain must not turn straight back");
      if (std::abs(cross(in, out)) <= kInLine) continue;
    }
    kept.push_back(all[i]);
  }
  if (kept.size() < (chain.closed ? 3u : 2u)) throw std::invalid_argument("points: must enclose something");
  return kept;
}

/// End of a segment that goes on straight behind its neighbour, at an inner corner: a body there meets both. The
/// neighbour covers the strip's end, from there to where the two backs meet.
Vector2d gone_on(const Knot& corner, const Vector2d& along, const Polygon& neighbour) {
  const Vector2d back = corner.depth * corner.inward, root = corner.point + back;
  const Vector2d far = (neighbour[2] == root ? neighbour[3] : neighbour[2]) - root;
  double length = back.dot(along) / kGoesOn;
  for (int halvings = 0; halvings < 8; ++halvings, length /= 2) {
    const Vector2d end = corner.point + length * along, face = end - root;
    const bool away = far.dot(face) < 0 || std::abs(cross(far, face)) >= kAway * far.norm() * face.norm();
    if (away && inside(neighbour, end, kBehind * corner.depth)) return end;
  }
  return corner.point;
}

}  // namespace

std::vector<Polygon> chain_pieces(const GroundChain& chain) {
  if (!(chain.depth >= 0) || !std::isfinite(chain.depth))
    throw std::invalid_argument("depth = " + detail::text_of(chain.depth) + ": must be >= 0");
  std::vector<Knot> knots = knots_of(chain);
  const std::size_t n = knots.size(), segments = chain.closed ? n : n - 1;
  const auto at = [&](std::size_t i) -> Knot& { return knots[i % n]; };

  Vector2d low = knots[0].point, high = low;
  double longest = 0;
  for (std::size_t i = 0; i < n; ++i) low = low.cwiseMin(knots[i].point), high = high.cwiseMax(knots[i].point);
  for (std::size_t i = 0; i < segments; ++i) longest = std::max(longest, (at(i + 1).point - at(i).point).norm());
  const double depth = chain.depth > 0 ? chain.depth : std::max(longest, (high - low).norm() / 10);
  for (std::size_t i = 0; i < n; ++i) {
    const bool first = !chain.closed && i == 0, last = !chain.closed && i + 1 == n;
    const Vector2d in = first ? way(at(0), at(1)) : way(at(i + n - 1), at(i));
    const Vector2d out = last ? in : way(at(i), at(i + 1));
    const Vector2d middle = (perp(in) + perp(out)).normalized();
    knots[i].inward = std::min(1 / middle.dot(perp(in)), kMitre) * middle;
    knots[i].depth = depth;
  }
  const auto piece = [&](std::size_t i) {
    const auto back = [](const Knot& j) -> Vector2d { return j.point + j.depth * j.inward; };
    return Polygon{at(i).point, at(i + 1).point, back(at(i + 1)), back(at(i))};
  };
  const auto fits = [&](std::size_t i) {
    const Polygon p = piece(i);
    if (!convex(p)) return false;
    for (std::size_t k = 0; k < segments; ++k) {
      if (k == i) continue;
      const bool before = (k + 1) % n == i, after = (i + 1) % n == k;  // they touch at a joint
      const Vector2d &from = at(k).point, &to = at(k + 1).point;
      if (cross_each_other(p[2], p[3], from, to)) return false;
      if (!after && cross_each_other(p[1], p[2], from, to)) return false;
      if (!before && cross_each_other(p[3], p[0], from, to)) return false;
    }
    return true;
  };
  for (std::size_t i = 0; i < segments; ++i)
    for (std::size_t k = i + 2; k < segments; ++k)
      if (!(chain.closed && i == 0 && k + 1 == segments) &&
          cross_each_other(at(i).point, at(i + 1).point, at(k).point, at(k + 1).point))
        throw std::invalid_argument("points: the segments from " + point_name(at(i).place) + " and from " +
                                    point_name(at(k).place) + " meet: the chain must not cross or touch itself");
  for (bool thinner = true; thinner;) {
    thinner = false;
    for (std::size_t i = 0; i < segments; ++i) {
      if (fits(i)) continue;
      thinner = true;
      at(i).depth /= 2, at(i + 1).depth /= 2;
      if (at(i).depth < std::ldexp(depth, -kHalvings))
        throw std::invalid_argument("points: the chain leaves no room for a strip behind " + point_name(at(i).place));
    }
  }
  const auto bends_in = [&](std::size_t i) {
    if (!chain.closed && (i % n == 0 || i % n + 1 == n)) return false;
    const Vector2d in = way(at(i + n - 1), at(i)), out = way(at(i), at(i + 1));
    return cross(in, out) < 0 && (cross(in, out) < -kBent || in.dot(out) < 0);
  };
  std::vector<Polygon> pieces;
  for (std::size_t i = 0; i < segments; ++i) {
    pieces.push_back(piece(i));
    const Vector2d along = way(at(i), at(i + 1));
    if (bends_in(i)) pieces.back()[0] = gone_on(at(i), -along, piece((i + segments - 1) % segments));
    if (bends_in(i + 1)) pieces.back()[1] = gone_on(at(i + 1), along, piece((i + 1) % segments));
  }
  if (chain.free_left) std::reverse(pieces.begin(), pieces.end());
  return pieces;
}

std::vector<PolygonPolygon> chain_polygon(const PolygonPolygon& pair, const GroundChain& chain) {
  std::vector<PolygonPolygon> all;
  int count = 0;
  for (Polygon& piece : chain_pieces(chain)) {
    PolygonPolygon one = pair;
    one.name += "_" + std::to_string(++count), one.corners_b = std::move(piece);
    for (const PolygonPolygon& point : polygon_polygon(one)) all.push_back(point);
  }
  return all;
}

std::vector<DiscPolygon> chain_disc(const DiscPolygon& disc, const GroundChain& chain) {
  std::vector<DiscPolygon> all;
  for (Polygon& piece : chain_pieces(chain)) {
    DiscPolygon& one = all.emplace_back(disc);
    one.corners = std::move(piece);
    one.name += "_" + std::to_string(all.size());
  }
  return all;
}

}  // namespace orthant
