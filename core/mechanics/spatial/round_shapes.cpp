#include <orthant/core/mechanics/spatial/round_shapes.h>

#include <limits>

namespace orthant::spatial {

std::pair<double, double> nearest(const Segment& a, const Segment& b) {
  const Vector3d u = a.q - a.p, w = b.q - b.p, r = a.p - b.p;
  const double uu = u.squaredNorm(), ww = w.squaredNorm(), uw = u.dot(w);
  if (!(uu > 0)) return {0, b.nearest(a.p)};
  if (!(ww > 0)) return {a.nearest(b.p), 0};
  const double square = uu * ww - uw * uw;
  if (!(square > kParallel * kParallel * uu * ww)) {  // at an end of one of them
    std::pair<double, double> best{0, 0};
    double least = std::numeric_limits<double>::infinity();
    const auto take = [&](double s, double t) {
      if (const double away = (a.at(s) - b.at(t)).squaredNorm(); away < least) least = away, best = {s, t};
    };
    for (const double end : {0.0, 1.0}) take(end, b.nearest(a.at(end))), take(a.nearest(b.at(end)), end);
    return best;
  }
  double s = std::clamp((uw * w.dot(r) - ww * u.dot(r)) / square, 0.0, 1.0);
  const double t = b.nearest(a.at(s));
  s = a.nearest(b.at(t));
  return {s, t};
}

TouchPoint grown(const Vector3d& p, double radius_p, const Vector3d& r, double radius_r) {
  const Vector3d d = p - r;
  const double length = d.norm();
  const Vector3d n = length > 0 ? Vector3d(d / length) : Vector3d(0, 0, 1);
  return {n, p - radius_p * n, r + radius_r * n, length - radius_p - radius_r};
}

namespace {

/// Whether the foot of the perpendicular from x lies on the segment, ends included.
bool foot_on(const Segment& a, const Vector3d& x) {
  constexpr double kEnd = 1e-9;
  const double s = (x - a.p).dot(a.q - a.p) / (a.q - a.p).squaredNorm();
  return s > -kEnd && s < 1 + kEnd;
}

}  // namespace

Segment core_of(const Pose& at, const Shape& x) {
  return {at.x + at.turn(x.corners.front()), at.x + at.turn(x.corners.back())};
}

void add_sorted(std::array<TouchPoint, 8>& found, std::size_t count, double same, TouchPoints& points) {
  const auto end = found.begin() + static_cast<std::ptrdiff_t>(count);
  std::stable_sort(found.begin(), end, [](const TouchPoint& x, const TouchPoint& y) { return x.gap < y.gap; });
  for (auto p = found.begin(); p != end; ++p)
    if (std::none_of(points.points.begin(), points.points.begin() + points.count,
                     [&](const TouchPoint& q) { return (p->on_a - q.on_a).norm() <= same; }))
      points.add(*p);
}

TouchPoints touch_round(const Segment& a, double radius_a, const Segment& b, double radius_b) {
  const auto [s, t] = nearest(a, b);
  std::array<TouchPoint, 8> found;
  std::size_t count = 0;
  found[count++] = grown(a.at(s), radius_a, b.at(t), radius_b);
  if (a.p != a.q && b.p != b.q) {
    // Of the ends whose foot lies on the other core: the first and the last one along both.
    const Vector3d u = (a.q - a.p).normalized(), w = (b.q - b.p).normalized(), along = u + (u.dot(w) < 0 ? -1 : 1) * w;
    TouchPoint first, last;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    const auto take = [&](const Vector3d& on_a, const Vector3d& on_b) {
      const double at = along.dot(on_a + on_b);
      if (at < least) least = at, first = grown(on_a, radius_a, on_b, radius_b);
      if (at > most) most = at, last = grown(on_a, radius_a, on_b, radius_b);
    };
    for (const Vector3d* end : {&a.p, &a.q})
      if (foot_on(b, *end)) take(*end, b.at(b.nearest(*end)));
    for (const Vector3d* end : {&b.p, &b.q})
      if (foot_on(a, *end)) take(a.at(a.nearest(*end)), *end);
    if (most >= least) found[count++] = first, found[count++] = last;
  }
  TouchPoints points;
  add_sorted(found, count, kSamePoint * ((a.q - a.p).norm() + radius_a), points);
  return points;
}

}  // namespace orthant::spatial
