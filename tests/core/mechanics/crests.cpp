// Penetration depth at crests and seams: gaps of a convex polygon against chains and flush convex pieces, compared with
// its depth in their union.
#include <doctest/doctest.h>

#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

#include <orthant/core/mechanics/planar/chain.h>

#include <numbers>

namespace orthant {
namespace {

using testing::Draws;
using testing::VectorXd;

double turn_of(const Vector2d& o, const Vector2d& p, const Vector2d& q) {
  return (p - o).x() * (q - o).y() - (p - o).y() * (q - o).x();
}

/// Corners of the convex hull, counter-clockwise (monotone chain).
Polygon hull_of_points(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(),
            [](const Vector2d& p, const Vector2d& q) { return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y(); });
  Polygon hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Vector2d& p : points) {
      while (hull.size() >= first + 2 && turn_of(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

double from_origin(const Vector2d& from, const Vector2d& to) {
  const double s = std::clamp(-from.dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
  return (from + s * (to - from)).norm();
}

/// The parts of a segment outside of a convex polygon or on its boundary, as [from, to] of its length.
using Parts = std::vector<std::pair<double, double>>;
Parts outside_of(const Polygon& q, const Vector2d& from, const Vector2d& to, const Parts& parts) {
  constexpr double kInside = 1e-11;  // [m]: an edge that two polygons share is inside neither
  double low = 0, high = 1;          // inside
  for (std::size_t i = 0; i < q.size(); ++i) {
    const Vector2d &p = q[i], along = (q[(i + 1) % q.size()] - p).normalized();
    const double start = turn_of(p, p + along, from) - kInside, end = turn_of(p, p + along, to) - kInside;
    const double slope = end - start;
    if (slope == 0 && start <= 0) return parts;
    if (slope > 0) low = std::max(low, -start / slope);
    if (slope < 0) high = std::min(high, -start / slope);
  }
  Parts left;
  for (const auto& [a, b] : parts) {
    if (low >= high || low >= b || high <= a) {
      left.emplace_back(a, b);
      continue;
    }
    if (a < low) left.emplace_back(a, low);
    if (high < b) left.emplace_back(high, b);
  }
  return left;
}

/// [m] The shortest translation that takes `one` out of the union of the pieces: the distance from the origin to the
/// boundary of the union of the Minkowski differences. 0: they do not overlap.
double depth_in_union(const Polygon& one, const std::vector<Polygon>& pieces) {
  std::vector<Polygon> differences;
  bool overlap = false;
  for (const Polygon& piece : pieces) {
    std::vector<Vector2d> points;
    for (const Vector2d& p : piece)
      for (const Vector2d& q : one) points.push_back(p - q);
    const Polygon& m = differences.emplace_back(hull_of_points(std::move(points)));
    bool inside = true;
    for (std::size_t i = 0; i < m.size(); ++i)
      inside = inside && turn_of(m[i], m[(i + 1) % m.size()], Vector2d::Zero()) > 0;
    overlap = overlap || inside;
  }
  if (!overlap) return 0;
  double least = kInf;
  for (std::size_t k = 0; k < differences.size(); ++k)
    for (std::size_t i = 0; i < differences[k].size(); ++i) {
      const Vector2d from = differences[k][i], to = differences[k][(i + 1) % differences[k].size()];
      Parts parts{{0, 1}};
      for (std::size_t l = 0; l < differences.size(); ++l)
        if (l != k) parts = outside_of(differences[l], from, to, parts);
      for (const auto& [a, b] : parts)
        least = std::min(least, from_origin(from + a * (to - from), from + b * (to - from)));
    }
  return least;
}

Polygon random_convex(Draws& random, double size) {
  for (;;) {
    std::vector<Vector2d> points;
    const int n = static_cast<int>(random(3, 8));
    for (int i = 0; i < n; ++i) points.push_back(random.point(size));
    Polygon p = hull_of_points(points);
    if (p.size() >= 3 && convex(p) && shortest_face(p) > 0.1 * size) return p;
  }
}

/// The part of a convex polygon on the left of a line, and the rest.
std::pair<Polygon, Polygon> cut(const Polygon& p, const Vector2d& at, const Vector2d& along) {
  std::pair<Polygon, Polygon> parts;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector2d &a = p[i], &b = p[next(p, i)];
    const double side_a = cross(along, a - at), side_b = cross(along, b - at);
    (side_a > 0 ? parts.first : parts.second).push_back(a);
    if ((side_a > 0) == (side_b > 0)) continue;
    const Vector2d on = a + side_a / (side_a - side_b) * (b - a);
    parts.first.push_back(on), parts.second.push_back(on);
  }
  return parts;
}

/// Pieces of a ground, and segments of its surface: the ground is on the right.
struct Crest {
  std::vector<Polygon> pieces;
  std::vector<std::pair<Vector2d, Vector2d>> segments;
};

Crest chain_crest(Draws& random) {
  const double up = random(-0.8, 1.2), down = up - random(0.02, 1.4);
  const std::vector<Vector2d> points = {random(0.7, 3) * Vector2d(-std::cos(up), -std::sin(up)),
                                        {0, 0},
                                        random(0.7, 3) * Vector2d(std::cos(down), std::sin(down))};
  return {chain_pieces({.points = points}), {{points[0], points[1]}, {points[1], points[2]}}};
}

/// Crests and valleys.
Crest chain_hills(Draws& random) {
  std::vector<Vector2d> points{{0, 0}};
  for (int left = static_cast<int>(random(3, 7)); left > 0; --left) {
    const double slope = random(-0.9, 0.9), length = random(0.2, 1);
    points.push_back(points.back() + length * Vector2d(std::cos(slope), std::sin(slope)));
  }
  Crest crest{chain_pieces({.points = points}), {}};
  for (std::size_t i = 0; i + 1 < points.size(); ++i) crest.segments.emplace_back(points[i], points[i + 1]);
  return crest;
}

/// A convex ground in two or three pieces.
Crest cut_crest(Draws& random) {
  for (;;) {
    const Polygon whole = random_convex(random, 2);
    Crest crest;
    for (std::size_t i = 0; i < whole.size(); ++i) crest.segments.emplace_back(whole[next(whole, i)], whole[i]);
    Vector2d middle(0, 0);
    for (const Vector2d& c : whole) middle += c / static_cast<double>(whole.size());
    const auto angle = [&] { return random(-std::numbers::pi, std::numbers::pi); };
    const bool at_corner = random(0, 1) < 0.6;  // a seam that ends at a corner of the whole
    const double first = angle(), second = angle();
    const Vector2d along =
        at_corner ? Vector2d((middle - whole[0]).normalized()) : Vector2d(std::cos(first), std::sin(first));
    auto [left, right] = cut(whole, middle, along);
    crest.pieces = {left};
    if (random(0, 1) < 0.5) {
      const auto [a, b] =
          cut(right, right[0] * 0.5 + right[1] * 0.25 + right[2] * 0.25, Vector2d(std::cos(second), std::sin(second)));
      crest.pieces.push_back(a), crest.pieces.push_back(b);
    } else {
      crest.pieces.push_back(right);
    }
    bool good = true;
    for (Polygon& p : crest.pieces) {
      Polygon apart;
      for (const Vector2d& c : p)
        if (apart.empty() || (c - apart.back()).norm() > 1e-9) apart.push_back(c);
      while (apart.size() > 1 && (apart.front() - apart.back()).norm() <= 1e-9) apart.pop_back();
      p = apart;
      good = good && convex(p) && shortest_face(p) > 0.2;
    }
    if (good) return crest;
  }
}

/// A pose in which a polygon lies on a segment, tilted by little or turned anyhow, some of it past the segment's end.
VectorXd pose_on(Draws& random, const Crest& crest, const Polygon& one) {
  const auto& [from, to] =
      crest.segments[static_cast<std::size_t>(random(0, static_cast<double>(crest.segments.size()) - 1e-9))];
  const Vector2d along = (to - from).normalized(), up = perp(along);
  const auto face = static_cast<std::size_t>(random(0, static_cast<double>(one.size()) - 1e-9));
  const Vector2d side = direction(one, face);
  const double flush = std::atan2(along.y(), along.x()) - std::atan2(side.y(), side.x());
  const double kind = random(0, 1), sign = random(0, 1) < 0.5 ? 1 : -1;
  const double tilt = kind < 0.1 ? 0 : kind < 0.7 ? sign * std::pow(10, random(-7, -1)) : random(-3, 3);
  const Eigen::Rotation2Dd turn(flush + tilt);
  double low = kInf, left = kInf, right = -kInf;
  for (const Vector2d& c : one) {
    const Vector2d p = turn * c;
    low = std::min(low, up.dot(p)), left = std::min(left, along.dot(p)), right = std::max(right, along.dot(p));
  }
  const double depth = std::pow(10, random(-6, -2));
  const Vector2d end = random(0, 1) < 0.5 ? from : to;
  const double past = random(0, 1) < 0.4 ? -left + sign * std::pow(10, random(-6, -1)) : random(-right, -left);
  VectorXd q(3);
  q << end + past * along - (low + depth) * up, flush + tilt;
  return q;
}

}  // namespace

TEST_CASE("on crests and flush pieces no gap is deeper than the polygon is in their union, and no contact is lost") {
  Draws random(31);
  int deeper = 0, lost = 0, overlapping = 0;
  for (int ground = 0; ground < 600; ++ground) {
    const Crest crest = ground % 3 == 0   ? chain_crest(random)
                        : ground % 3 == 1 ? cut_crest(random)
                                          : chain_hills(random);
    const Polygon one = random_convex(random, 0.3);
    Scene s;
    s.body({});
    for (const Polygon& piece : crest.pieces)
      s.contact_set(polygon_polygon({"piece" + std::to_string(s.contacts.size()), 0, one, kGround, piece, 0, {}}));
    const System system(s);
    for (int i = 0; i < 100; ++i) {
      const VectorXd q = pose_on(random, crest, one);
      Polygon here;
      for (const Vector2d& c : one) here.push_back(q.head<2>() + Eigen::Rotation2Dd(q[2]) * c);
      const double depth = depth_in_union(here, crest.pieces);
      const double gap = testing::all_terms(system, q, VectorXd::Zero(3)).gap.minCoeff();
      if (depth > 0.05) continue;  // through a wall of a valley
      overlapping += depth > 0;
      if (gap < -depth - 1e-9 && ++deeper <= 5)
        MESSAGE("ground ", ground, " pose ", i, ": gap ", gap, " at a depth of ", depth);
      if (depth > 1e-9 && gap > -depth / 2 && ++lost <= 5)
        MESSAGE("ground ", ground, " pose ", i, ": gap ", gap, " at a depth of ", depth, ": lost");
    }
  }
  CHECK(overlapping > 20000);
  CHECK(deeper == 0);
  CHECK(lost == 0);
}

}  // namespace orthant
