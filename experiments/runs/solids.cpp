#include "experiments/runs/solids.h"

#include <orthant/core/mechanics/spatial/hull.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

namespace orthant {
namespace {

using Points = std::vector<Vector3d>;
using spatial::Matrix3d;

constexpr int kAround = 16, kUp = 8;  // facets of a sphere
constexpr std::size_t kMostCorners = 60;
constexpr double kThin = 0.008;    // thickness of a link, of the scene's size
constexpr double kLargestBox = 4;  // edge of a box of inertia, of the scene's size

/// Unit vectors on a spiral over the sphere.
Points spiral() {
  Points all;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));  // the golden angle
  for (std::size_t i = 0; i < kMostCorners; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / kMostCorners, r = std::sqrt(1 - z * z);
    const double a = turn * static_cast<double>(i);
    all.emplace_back(r * std::cos(a), r * std::sin(a), z);
  }
  return all;
}

/// A ring of kAround points about the axis, from the reference x.
void add_ring(const Vector3d& centre, const Vector3d& x, const Vector3d& y, double radius, Points& points) {
  for (int i = 0; i < kAround; ++i) {
    const double a = 2 * std::numbers::pi * i / kAround;
    points.push_back(centre + radius * (std::cos(a) * x + std::sin(a) * y));
  }
}

/// A sphere with its upper half at one end, its lower half at the other; both may coincide.
Faces round_ended(const Vector3d& low, const Vector3d& high, const Vector3d& axis, double radius) {
  const Vector3d x = spatial::perpendicular(axis), y = axis.cross(x);
  Faces all;
  for (int k = 1; k < kUp; ++k) {
    const double a = std::numbers::pi * (static_cast<double>(k) / kUp - 0.5);  // latitude
    if (2 * k == kUp && low != high) add_ring(low, x, y, radius, all.points);  // the equator twice
    add_ring((2 * k < kUp ? low : high) + radius * std::sin(a) * axis, x, y, radius * std::cos(a), all.points);
  }
  const int rings = static_cast<int>(all.points.size()) / kAround;
  const int bottom = rings * kAround, top = bottom + 1;
  all.points.push_back(low - radius * axis), all.points.push_back(high + radius * axis);
  for (int i = 0; i < kAround; ++i) {
    const int j = (i + 1) % kAround, last = (rings - 1) * kAround;
    all.faces.push_back({bottom, j, i});
    for (int k = 0; k + 1 < rings; ++k)
      all.faces.push_back({k * kAround + i, k * kAround + j, (k + 1) * kAround + j, (k + 1) * kAround + i});
    all.faces.push_back({last + i, last + j, top});
  }
  return all;
}

class SolidSketch {
 public:
  explicit SolidSketch(const spatial::Scene& scene) : scene_(scene), shaped_(scene.bodies.size()) {
    for (const spatial::Body& b : scene.bodies) middle_ += b.position / static_cast<double>(scene.bodies.size());
    for (const spatial::Body& b : scene.bodies) grow(b.position);
  }

  void operator()(const spatial::SpherePlane& c) {
    if (c.radius > 0)
      sphere(c.a, c.centre, c.radius);
    else
      corners_[c.a].push_back(c.centre), reach(c.a, c.centre), shape(c.a);
    planes_.push_back({c.b, c.plane_point, c.normal});
  }
  void operator()(const spatial::SphereSphere& c) {
    sphere(c.a, c.centre_a, c.radius_a), sphere(c.b, c.centre_b, c.radius_b);
  }
  void operator()(const spatial::Socket& c) {
    sphere(c.a, c.centre_a, c.radius_a), link(c.a, c.centre_a);
    if (!known(c.b, c.centre_b, c.radius_b)) all_.push_back({c.b, drawn::Sphere{c.centre_b, c.radius_b, true}});
    link(c.b, c.centre_b);
  }
  void operator()(const spatial::PinBush& c) {  // the rim, once a body of each
    const Vector3d x = spatial::perpendicular(c.axis_a), y = c.axis_a.cross(x);
    add_ring(c.centre_a + c.along * c.axis_a, x, y, c.radius_a, corners_[c.a]);
    reach(c.a, c.centre_a, c.radius_a), shape(c.a), link(c.a, c.centre_a), link(c.b, c.centre_b);
  }
  void operator()(const spatial::SphereBush& c) {  // the ball, and its circle in the cylinder at the start
    sphere(c.a, c.centre_a, c.radius_a);
    const Vector3d x = spatial::perpendicular(c.axis_b), y = c.axis_b.cross(x);
    std::vector<Vector3d> circle;
    add_ring(c.centre_b + level(c) * c.axis_b, x, y, c.radius_b, circle);
    for (std::size_t i = 0; i < circle.size(); ++i)
      all_.push_back({c.b, drawn::Capsule{circle[i], circle[(i + 1) % circle.size()], kThin * c.radius_b}});
    reach(c.b, c.centre_b, c.radius_b);
  }
  void operator()(const spatial::EllipsoidPlane& c) {
    const Matrix3d R = quaternions::matrix_of(c.orientation);
    for (const Vector3d& d : spiral()) corners_[c.a].push_back(c.centre + R * c.semi_axes.cwiseProduct(d));
    reach(c.a, c.centre, c.semi_axes.maxCoeff()), shape(c.a);
    planes_.push_back({c.b, c.plane_point, c.normal});
  }
  void operator()(const spatial::RimPlane& c) {
    if (c.phase != 0) return;  // the same circle
    const Vector3d x = spatial::perpendicular(c.axis);
    add_ring(c.centre, x, c.axis.cross(x), c.radius, corners_[c.a]);
    reach(c.a, c.centre, c.radius), shape(c.a);
    planes_.push_back({c.b, c.plane_point, c.normal});
  }
  void operator()(const spatial::Collision& c) {
    for (const spatial::Shape& s : c.shapes) {
      for (const Vector3d& corner : s.corners) reach(s.body, corner, s.radius);
      shape(s.body);
      if (s.sphere())
        sphere(s.body, s.corners[0], s.radius);
      else if (s.capsule())
        all_.push_back({s.body, drawn::Capsule{s.corners[0], s.corners[1], s.radius}});
      else
        all_.push_back({s.body, drawn::Polytope{convex_hull(s.corners)}}), whole_.insert(s.body);
    }
  }
  void operator()(const spatial::Limit&) {}
  void operator()(const spatial::Backlash& c) { (*this)(c.gear); }
  template <class Joint>
    requires requires(const Joint& j) { j.point_a; }
  void operator()(const Joint& j) { link(j.a, j.point_a), link(j.b, j.point_b); }
  void operator()(const spatial::Drive&) {}
  /// The pitch circles of two wheels about parallel axes of the ground, through their centres of mass.
  void operator()(const spatial::Gear& g) {
    const auto *one = std::get_if<spatial::Angle>(&g.first), *other = std::get_if<spatial::Angle>(&g.second);
    if (one == nullptr || other == nullptr || one->a >= 0 || other->a >= 0 || one->b < 0 || other->b < 0) return;
    const Vector3d& u = one->axis_a;
    if (!(u.cross(other->axis_a).norm() < 1e-9)) return;
    const double ratio = g.ratio * (u.dot(other->axis_a) < 0 ? -1 : 1);  // of both about u; > 0: inner teeth
    const auto centre = [&](const spatial::Angle& of) {
      return scene_.bodies[static_cast<std::size_t>(of.b)].position;
    };
    const double radius = u.cross(centre(*other) - centre(*one)).norm() / std::abs(1 - 1 / ratio);
    if (!(radius > 0 && radius < std::numeric_limits<double>::infinity())) return;
    const auto draw = [&](const spatial::Angle& wheel, double r) {
      const Vector3d x = spatial::perpendicular(wheel.axis_b), none = Vector3d::Zero();
      add_ring(none, x, wheel.axis_b.cross(x), r, corners_[wheel.b]), reach(wheel.b, none, r), shape(wheel.b);
    };
    draw(*one, radius), draw(*other, radius / std::abs(ratio));
  }

  std::vector<DrawnSolid> finish() {
    const double size = size_ > 0 ? size_ : 1, thin = kThin * size;
    for (const auto& [body, points] : corners_)
      if (!whole_.contains(body)) hull(body, points, thin);
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
      if (!shaped_[i]) box_of_inertia(static_cast<BodyId>(i), size, thin);
    for (const auto& [body, point] : links_)
      if (!in_box(body, point)) all_.push_back({body, drawn::Capsule{Vector3d::Zero(), point, thin}});
    for (const Wall& w : planes_) plane(w, size);
    return std::move(all_);
  }

 private:
  /// [m] of a ball along its bush's axis, from the bush's centre, in the initial poses.
  double level(const spatial::SphereBush& c) const {
    const auto pose = [&](BodyId b) {
      return b == kGround ? std::pair{Vector3d(0, 0, 0), Matrix3d(Matrix3d::Identity())}
                          : std::pair{scene_.bodies[static_cast<std::size_t>(b)].position,
                                      quaternions::matrix_of(scene_.bodies[static_cast<std::size_t>(b)].orientation)};
    };
    const auto [x_a, R_a] = pose(c.a);
    const auto [x_b, R_b] = pose(c.b);
    return c.axis_b.dot(R_b.transpose() * (x_a + R_a * c.centre_a - x_b) - c.centre_b);
  }
  struct Wall {
    BodyId body;
    Vector3d point, normal;
  };

  void grow(const Vector3d& p) { size_ = std::max(size_, 2 * (p - middle_).norm()); }
  /// A point of a body in the initial pose.
  void reach(BodyId body, const Vector3d& point, double radius = 0) {
    if (body == kGround) return grow(point);
    const spatial::Body& b = scene_.bodies[static_cast<std::size_t>(body)];
    grow(b.position + quaternions::matrix_of(b.orientation) * point), size_ = std::max(size_, 2 * radius);
  }
  void shape(BodyId body) {
    if (body != kGround) shaped_[static_cast<std::size_t>(body)] = true;
  }
  bool known(BodyId body, const Vector3d& centre, double radius) const {
    return std::any_of(all_.begin(), all_.end(), [&](const DrawnSolid& s) {
      const auto* one = std::get_if<drawn::Sphere>(&s.shape);
      return one && s.body == body && one->centre == centre && one->radius == radius;
    });
  }
  void sphere(BodyId body, const Vector3d& centre, double radius) {
    if (!known(body, centre, radius)) all_.push_back({body, drawn::Sphere{centre, radius}});
    reach(body, centre, radius), shape(body);
  }
  /// From the centre of mass to where something holds the body.
  void link(BodyId body, const Vector3d& point) {
    reach(body, point);
    const std::pair<BodyId, Vector3d> one{body, point};
    if (body != kGround && !point.isZero(0) && std::find(links_.begin(), links_.end(), one) == links_.end())
      links_.push_back(one);
  }
  void hull(BodyId body, const Points& points, double thin) {
    drawn::Polytope polytope{convex_hull(points)};
    if (!polytope.faces.empty()) return all_.push_back({body, std::move(polytope)});
    const auto before = [](const Vector3d& p, const Vector3d& q) {
      return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    };
    const auto [from, to] = std::minmax_element(points.begin(), points.end(), before);
    if (*from == *to)
      all_.push_back({body, drawn::Sphere{*from, thin}});
    else
      all_.push_back({body, drawn::Capsule{*from, *to, thin}});
  }
  void box_of_inertia(BodyId body, double size, double thin) {
    const spatial::Body& b = scene_.bodies[static_cast<std::size_t>(body)];
    const spatial::Principal own = spatial::principal(b.inertia);
    const Vector3d edges =
        (6 / b.mass * (Vector3d::Constant(own.moments.sum()) - 2 * own.moments)).cwiseMax(0).cwiseSqrt();
    if (edges.maxCoeff() > kLargestBox * size) {  // not of such a body
      all_.push_back({body, drawn::Sphere{Vector3d::Zero(), 2 * thin}});
      return;
    }
    const Vector3d half = (edges / 2).cwiseMax(Vector3d::Constant(thin));
    const Matrix3d turn = quaternions::matrix_of(own.axes);
    boxes_[body] = {turn, half};
    Points corners = spatial::box_corners(half);
    for (Vector3d& corner : corners) corner = turn * corner;
    all_.push_back({body, drawn::Polytope{convex_hull(corners)}});
  }
  /// Whether a link to the point would be hidden in the body's box of inertia.
  bool in_box(BodyId body, const Vector3d& point) const {
    const auto box = boxes_.find(body);
    if (box == boxes_.end()) return false;
    const auto& [turn, half] = box->second;
    return ((turn.transpose() * point).cwiseAbs().array() <= 1.01 * half.array()).all();
  }
  /// About the scene's middle, in the initial pose.
  void plane(const Wall& w, double size) {
    Vector3d middle = middle_;
    if (w.body != kGround) {
      const spatial::Body& b = scene_.bodies[static_cast<std::size_t>(w.body)];
      middle = quaternions::matrix_of(b.orientation).transpose() * (middle_ - b.position);
    }
    const drawn::Plane one{middle - w.normal.dot(middle - w.point) * w.normal, w.normal, 0.75 * size};
    const bool there = std::any_of(all_.begin(), all_.end(), [&](const DrawnSolid& s) {
      const auto* p = std::get_if<drawn::Plane>(&s.shape);
      return p && s.body == w.body && p->normal == one.normal && (p->point - one.point).norm() <= 1e-9 * size;
    });
    if (!there) all_.push_back({w.body, one});
  }

  const spatial::Scene& scene_;
  Vector3d middle_ = Vector3d::Zero();
  double size_ = 0;
  std::vector<bool> shaped_;
  std::vector<DrawnSolid> all_;
  std::vector<std::pair<BodyId, Vector3d>> links_;
  std::vector<Wall> planes_;
  std::map<BodyId, Points> corners_;
  std::set<BodyId> whole_;                                 // drawn as a polytope of a collision
  std::map<BodyId, std::pair<Matrix3d, Vector3d>> boxes_;  // of inertia: principal axes, half edges
};

}  // namespace

Faces convex_hull(const std::vector<Vector3d>& points) {
  Faces all;
  try {
    const spatial::Hull hull = spatial::fit_hull(points, kMostCorners).hull;
    all.points = hull.corners;
    for (const spatial::Hull::Face& face : hull.faces) all.faces.push_back(face.corners);
  } catch (const std::invalid_argument&) {  // flat
    all.points = spatial::flat_hull(points);
    if (all.points.empty()) return all;
    std::vector<int>& polygon = all.faces.emplace_back(all.points.size());
    std::iota(polygon.begin(), polygon.end(), 0);
  }
  return all;
}

std::vector<DrawnSolid> solids(const spatial::Scene& scene) {
  SolidSketch sketch(scene);
  for (const spatial::Joint& j : scene.joints) std::visit(sketch, j);
  for (const spatial::Contact& c : scene.contacts) std::visit(sketch, c);
  for (const spatial::Collision& c : scene.collisions) sketch(c);
  return sketch.finish();
}

Faces surface(const DrawnSolid& solid) {
  if (const auto* sphere = std::get_if<drawn::Sphere>(&solid.shape))
    return round_ended(sphere->centre, sphere->centre, {0, 0, 1}, sphere->radius);
  if (const auto* capsule = std::get_if<drawn::Capsule>(&solid.shape))
    return round_ended(capsule->from, capsule->to, (capsule->to - capsule->from).normalized(), capsule->radius);
  if (const auto* polytope = std::get_if<drawn::Polytope>(&solid.shape)) return *polytope;
  const auto& plane = std::get<drawn::Plane>(solid.shape);
  const Vector3d x = plane.half * spatial::perpendicular(plane.normal), y = plane.normal.cross(x);
  return {{plane.point - x - y, plane.point + x - y, plane.point + x + y, plane.point - x + y}, {{0, 1, 2, 3}}};
}

}  // namespace orthant
