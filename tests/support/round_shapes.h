// tests/support/round_shapes.h — spheres and capsules against other shapes: signed distances by independent sums.
#pragma once

#include <orthant/core/mechanics/spatial/collision.h>
#include <orthant/core/support/random.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace orthant {

inline constexpr double kNowhere = std::numeric_limits<double>::infinity();
inline constexpr double kRodRadius = 0.12;  // [m]

inline Vector3d anywhere_in(Random& random, double size) {
  const double x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}
inline Eigen::Matrix3d any_turn(Random& random) {
  const double w = random.uniform(-1, 1), x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return Eigen::Quaterniond(w, x, y, random.uniform(-1, 1)).normalized().toRotationMatrix();
}
inline spatial::Shape capsule_along_x(BodyId body, double half, double radius = kRodRadius) {
  return {body, {{-half, 0, 0}, {half, 0, 0}}, radius};
}
inline spatial::Shape box_between(BodyId body, const Vector3d& low, const Vector3d& high) {
  spatial::Shape s{body, spatial::box_corners((high - low) / 2), 0};
  for (Vector3d& p : s.corners) p += (low + high) / 2;
  return s;
}
inline spatial::Collision hulled(std::vector<spatial::Shape> shapes) {
  spatial::Collision c{.name = "set", .shapes = std::move(shapes), .law = {}};
  spatial::set_hulls(c);
  return c;
}

inline double smallest_gap(const spatial::TouchPoints& points) {
  double least = kNowhere;
  for (int i = 0; i < points.count; ++i) least = std::min(least, points.at(i).gap);
  return least;
}

/// Least value of a convex function on [0, 1].
template <class Function> double least_of(Function&& f) {
  double low = 0, high = 1, best = std::min(f(0.0), f(1.0));
  for (int i = 0; i < 60; ++i) {
    const double x = low + (high - low) / 3, y = high - (high - low) / 3, at_x = f(x), at_y = f(y);
    best = std::min({best, at_x, at_y});
    (at_x <= at_y ? high : low) = at_x <= at_y ? y : x;
  }
  return best;
}
inline double distance_to_segment(const Vector3d& x, const Vector3d& p, const Vector3d& q) {
  const double square = (q - p).squaredNorm();
  const double s = square > 0 ? std::clamp((x - p).dot(q - p) / square, 0.0, 1.0) : 0;
  return (x - p - s * (q - p)).norm();
}
/// 0 inside.
inline double distance_to_hull(const Vector3d& x, const spatial::Hull& hull) {
  if (hull.depth_of(x) <= 0) return 0;
  double least = kNowhere;
  for (const spatial::Hull::Face& face : hull.faces) {
    const double height = face.normal.dot(x) - face.offset;
    bool within = height > 0;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const Vector3d &p = hull.corners[static_cast<std::size_t>(face.corners[i])],
                     &q = hull.corners[static_cast<std::size_t>(face.corners[(i + 1) % face.corners.size()])];
      least = std::min(least, distance_to_segment(x, p, q));
      within = within && face.normal.dot((q - p).cross(x - p)) >= 0;
    }
    if (within) least = std::min(least, height);
  }
  return least;
}

/// A core, from p to q, and a polytope: their distance, or < 0 the shortest translation that parts them.
inline double signed_distance(const Vector3d& p, const Vector3d& q, const spatial::Hull& hull) {
  const double away = least_of([&](double s) { return distance_to_hull(p + s * (q - p), hull); });
  if (away > 0) return away;
  double most = -kNowhere;
  const auto look = [&](const Vector3d& n) {
    double high = -kNowhere;
    for (const Vector3d& corner : hull.corners) high = std::max(high, n.dot(corner));
    most = std::max(most, std::min(n.dot(p), n.dot(q)) - high);
  };
  for (const spatial::Hull::Face& face : hull.faces) look(face.normal);
  for (const spatial::Hull::Edge& e : hull.edges) {
    const Vector3d n =
        (q - p).cross(hull.corners[static_cast<std::size_t>(e.to)] - hull.corners[static_cast<std::size_t>(e.from)]);
    if (n.norm() < 1e-12) continue;
    look(n.normalized()), look(-n.normalized());
  }
  return most;
}

struct PlacedShape {
  const spatial::Shape& shape;
  spatial::Pose pose;
  Vector3d end(bool last) const { return pose.x + pose.turn(last ? shape.corners.back() : shape.corners.front()); }
};
/// The gap of a sphere or capsule to another shape.
inline double true_gap(const PlacedShape& round, const PlacedShape& other) {
  const Vector3d p = round.end(false), q = round.end(true);
  if (other.shape.polytope()) {
    const auto in = [&](const Vector3d& x) { return Vector3d(other.pose.turn_back(x - other.pose.x)); };
    return signed_distance(in(p), in(q), *other.shape.hull) - round.shape.radius;
  }
  const Vector3d u = other.end(false), v = other.end(true);
  return least_of([&](double s) { return distance_to_segment(p + s * (q - p), u, v); }) - round.shape.radius -
         other.shape.radius;
}

/// How far a shape reaches along a direction.
inline double reach_along(const PlacedShape& one, const Vector3d& n) {
  double most = -kNowhere;
  for (const Vector3d& p : one.shape.corners) most = std::max(most, n.dot(one.pose.x + one.pose.turn(p)));
  return most + one.shape.radius;
}
/// How far a point is outside of a shape.
inline double outside_of_shape(const PlacedShape& one, const Vector3d& x) {
  if (one.shape.polytope()) return distance_to_hull(one.pose.turn_back(x - one.pose.x), *one.shape.hull);
  return std::max(0.0, distance_to_segment(x, one.end(false), one.end(true)) - one.shape.radius);
}

/// A pose whose gap to the other shape is about `gap`, along a random direction.
inline spatial::Pose pose_at_gap(Random& random, const spatial::Shape& round, const PlacedShape& other, double gap) {
  spatial::Pose pose;
  pose.R = any_turn(random);
  const Vector3d start = other.pose.x + anywhere_in(random, 0.1), way = anywhere_in(random, 1).normalized();
  double low = 0, high = 2;
  for (int i = 0; i < 12; ++i) {
    pose.x = start + (low + high) / 2 * way;
    (true_gap({round, pose}, other) > gap ? high : low) = (low + high) / 2;
  }
  return pose;
}

}  // namespace orthant
