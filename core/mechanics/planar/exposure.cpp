#include <orthant/core/mechanics/planar/exposure.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace orthant {
namespace {

constexpr double kStraight = 1e-5;  // [rad] a free angle this near to π is flat
constexpr double kSliver = 64;      // of flush: part of a face that two sharp ends may leave uncovered
constexpr double kTurn = 2 * std::numbers::pi;

using Interval = std::pair<double, double>;

double angle_of(const Vector2d& d) { return std::atan2(d.y(), d.x()); }
Vector2d unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// The sector that a solid fills about p, as [begin, begin + width]: width 0: none. The solid's boundary is this far
/// from p.
struct Sector {
  double begin = 0, width = 0, apart = 0;
};

Sector sector_at(const Solid& solid, const Vector2d& p, double near) {
  if (solid.polygon == nullptr) {
    const double depth = -solid.normal.dot(p - solid.point);
    if (depth < -near) return {};
    if (depth > near) return {0, kTurn, 0};
    return {angle_of(solid.normal) + std::numbers::pi / 2, std::numbers::pi, std::abs(depth)};
  }
  const Polygon& q = *solid.polygon;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (const double apart = (q[i] - p).norm(); apart <= near) {
      const double out = angle_of(direction(q, i)), in = angle_of(-direction(q, i ? i - 1 : q.size() - 1));
      return {out, in > out ? in - out : in - out + kTurn, apart};
    }
    most = std::max(most, outward(q, i).dot(p - q[i]));
  }
  if (most > near) return {};
  if (most < -near) return {0, kTurn, 0};
  for (std::size_t i = 0; i < q.size(); ++i)
    if (outward(q, i).dot(p - q[i]) >= -near) return {angle_of(direction(q, i)), std::numbers::pi, std::abs(most)};
  return {};
}

/// Unions of intervals, those that meet within `slack` as one; ascending.
std::vector<Interval> merged(std::vector<Interval> all, double slack) {
  std::sort(all.begin(), all.end());
  std::vector<Interval> result;
  for (const Interval& one : all)
    if (!result.empty() && one.first <= result.back().second + slack)
      result.back().second = std::max(result.back().second, one.second);
    else
      result.push_back(one);
  return result;
}

/// Normals at corner i: of the free sectors that begin or end with one of its own faces.
Exposure::Cone cone_at(const Polygon& p, std::size_t i, std::span<const Solid> solids, double near) {
  // Angles are counted from the corner's outgoing face; its own sector begins at 0.
  const double zero = angle_of(direction(p, i));
  std::vector<Interval> filled;
  Exposure::Cone cone;
  for (const Solid& solid : solids) {
    const Sector s = sector_at(solid, p[i], near);
    if (s.width >= kTurn) return {};
    if (s.width <= 0) continue;
    cone.apart = std::max(cone.apart, s.apart);
    double begin = std::fmod(s.begin - zero, kTurn);
    if (begin < -kStraight) begin += kTurn;
    filled.emplace_back(begin, std::min(begin + s.width, kTurn));
    if (begin + s.width > kTurn) filled.emplace_back(0.0, begin + s.width - kTurn);
  }
  const auto solid = merged(std::move(filled), kStraight);
  double begin = 0, width = 0;  // of the widest free sector
  for (std::size_t k = 0; k < solid.size(); ++k) {
    const double to = k + 1 < solid.size() ? solid[k + 1].first : solid.front().first + kTurn;
    if (to - solid[k].second > width) begin = solid[k].second, width = to - begin;
  }
  cone.convex = width > std::numbers::pi + kStraight;
  cone.flat = !cone.convex && width >= std::numbers::pi - kStraight;
  if (!cone.convex) return cone;
  cone.from = unit(zero + begin + std::numbers::pi / 2);
  cone.to = unit(zero + begin + width - std::numbers::pi / 2);
  return cone;
}

/// The part of face i that a solid covers, as parts of its length.
void cover(const Polygon& p, std::size_t i, const Solid& solid, double near, std::vector<Interval>& covered) {
  const Vector2d &from = p[i], along = direction(p, i), n = outward(p, i);
  const double length = (p[next(p, i)] - from).norm();
  if (solid.polygon == nullptr) {
    if (solid.normal.dot(from - solid.point) <= near && solid.normal.dot(p[next(p, i)] - solid.point) <= near &&
        solid.normal.dot(n) < 1 - 1e-9)
      covered.emplace_back(0, length);
    return;
  }
  // What lies just outside the face is inside the polygon: the line at `near` outside, clipped by its faces.
  const Polygon& q = *solid.polygon;
  double low = 0, high = length;
  for (std::size_t k = 0; k < q.size() && low < high; ++k) {
    const Vector2d m = outward(q, k);
    const double at = m.dot(from + 2 * near * n - q[k]) - near, slope = m.dot(along);
    if (std::abs(slope) * length <= near) {
      if (at > 0) return;
    } else if (slope > 0) {
      high = std::min(high, -at / slope);
    } else {
      low = std::max(low, -at / slope);
    }
  }
  if (high > low) covered.emplace_back(low, high);
}

struct Box {
  Vector2d low, high;
};
Box box_of(const Polygon& p) {
  Box b{p[0], p[0]};
  for (const Vector2d& c : p) b.low = b.low.cwiseMin(c), b.high = b.high.cwiseMax(c);
  return b;
}

}  // namespace

Exposed exposure(std::span<const Solid> solids, std::size_t which) {
  const Polygon& p = *solids[which].polygon;
  const double near = kFlush * shortest_face(p);
  const Box own = box_of(p);
  std::vector<Solid> close{solids[which]};
  for (std::size_t k = 0; k < solids.size(); ++k) {
    if (k == which || (solids[k].polygon != nullptr && *solids[k].polygon == p)) continue;
    bool meets = true;
    if (solids[k].polygon != nullptr) {
      const Box other = box_of(*solids[k].polygon);
      meets =
          (own.low.array() <= other.high.array() + near).all() && (other.low.array() <= own.high.array() + near).all();
    } else {
      meets = std::any_of(p.begin(), p.end(),
                          [&](const Vector2d& c) { return solids[k].normal.dot(c - solids[k].point) <= near; });
    }
    if (meets) close.push_back(solids[k]);
  }
  if (close.size() == 1) return nullptr;
  auto e = std::make_shared<Exposure>();
  bool whole = true;
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::vector<Interval> covered;
    for (std::size_t k = 1; k < close.size(); ++k) cover(p, i, close[k], near, covered);
    const double length = (p[next(p, i)] - p[i]).norm();
    covered = merged(std::move(covered), kSliver * near);
    const bool all =
        covered.size() == 1 && covered[0].first <= kSliver * near && covered[0].second >= length - kSliver * near;
    e->face.push_back({!all, outward(p, i)});
    e->corner.push_back(cone_at(p, i, close, near));
    whole = whole && !all && e->points_to(i, outward(p, i)) && e->points_to(i, outward(p, i ? i - 1 : p.size() - 1));
  }
  return whole ? nullptr : e;
}

}  // namespace orthant
