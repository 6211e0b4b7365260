#include "experiments/runs/outlines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace orthant {
namespace {

using Corners = std::vector<Vector2d>;

Corners circle(const Vector2d& centre, double radius) {
  constexpr int kSides = 48;
  Corners corners;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    corners.push_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

/// By Andrew's monotone chain; fewer than three corners stay what they are.
Corners hull_of(Corners points) {
  const auto before = [](const Vector2d& p, const Vector2d& q) {
    return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y();
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Corners hull;
  for (const int pass : {0, 1}) {
    const std::size_t first = hull.size();
    for (const Vector2d& p : points) {
      const auto turns_right = [&](const Vector2d& a, const Vector2d& b) {
        return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x() <= 0;
      };
      while (hull.size() >= first + 2 && turns_right(hull[hull.size() - 2], hull.back())) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    if (pass == 0) std::reverse(points.begin(), points.end());
  }
  return hull;
}

class Sketch {
 public:
  explicit Sketch(const Scene& scene) {
    for (const Body& b : scene.bodies) reach_ = std::max(reach_, b.position.norm());
  }
  void add(BodyId body, bool closed, const Corners& corners, bool wall = false) {
    for (const Outline& o : all_)
      if (o.body == body && o.closed == closed && o.corners == corners) return;
    all_.push_back({body, closed, wall, corners});
    for (const Vector2d& c : corners) reach_ = std::max(reach_, c.norm());
  }
  void disc(BodyId body, const Vector2d& centre, double radius) {
    add(body, true, circle(centre, radius));
    if (body != kGround) add(body, false, {centre, centre + Vector2d(radius, 0)});
  }
  /// From the centre of mass to where something holds the body.
  void link(BodyId body, const Vector2d& point) {
    if (body != kGround && point != Vector2d(0, 0)) add(body, false, {Vector2d(0, 0), point});
  }
  void wall(BodyId body, const Vector2d& point, const Vector2d& normal) { walls_.push_back({body, point, normal}); }
  void corner(BodyId body, const Vector2d& point) { corners_[body].push_back(point); }

  void operator()(const CornerWall& c) { corner(c.a, c.point), wall(c.b, c.wall_point, c.normal); }
  void operator()(const DiscWall& c) { disc(c.a, c.centre, c.radius), wall(c.b, c.wall_point, c.normal); }
  void operator()(const DiscDisc& c) { disc(c.a, c.centre_a, c.radius_a), disc(c.b, c.centre_b, c.radius_b); }
  void operator()(const DiscPolygon& c) { disc(c.a, c.centre, c.radius), polygon(c.b, c.corners); }
  void operator()(const PolygonPolygon& c) { polygon(c.a, c.corners_a), polygon(c.b, c.corners_b); }
  void operator()(const Journal& c) {
    add(c.a, true, circle(c.centre_a, c.radius_a)), add(c.b, true, circle(c.centre_b, c.radius_b));
    link(c.a, c.centre_a), link(c.b, c.centre_b);
  }
  void operator()(const Limit&) {}
  void operator()(const Collision& c) {
    for (const Shape& s : c.shapes) s.corners.empty() ? disc(s.body, s.centre, s.radius) : polygon(s.body, s.corners);
  }
  template <class Joint>
    requires requires(const Joint& j) { j.point_a; }
  void operator()(const Joint& j) { link(j.a, j.point_a), link(j.b, j.point_b); }
  void operator()(const Drive&) {}
  void operator()(const CustomJoint&) {}
  void operator()(const CustomContact&) {}

  std::vector<Outline> finish() {
    for (const auto& [body, points] : corners_)
      if (const Corners hull = hull_of(points); hull.size() > 1) add(body, hull.size() > 2, hull);
    const double length = 1.5 * reach_;
    const auto walls = std::move(walls_);
    for (const Wall& w : walls) {
      const Vector2d along = length * Vector2d(-w.normal.y(), w.normal.x());
      add(w.body, false, {w.point - along, w.point + along}, true);
    }
    return std::move(all_);
  }

 private:
  struct Wall {
    BodyId body;
    Vector2d point, normal;
  };
  template <class Polygon> void polygon(BodyId body, const Polygon& p) { add(body, true, Corners(p.begin(), p.end())); }

  double reach_ = 0;
  std::vector<Outline> all_;
  std::vector<Wall> walls_;
  std::map<BodyId, Corners> corners_;
};

}  // namespace

std::vector<Outline> outlines(const Scene& scene) {
  Sketch sketch(scene);
  for (const Joint& j : scene.joints) std::visit(sketch, j);
  for (const Contact& c : scene.contacts) std::visit(sketch, c);
  for (const Collision& c : scene.collisions) sketch(c);
  return sketch.finish();
}

}  // namespace orthant
