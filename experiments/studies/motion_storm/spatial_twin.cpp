#include "experiments/studies/motion_storm/spatial_twin.h"

#include <algorithm>

namespace orthant::motion_storm {
namespace {

namespace sp = spatial;

class SpatialChange {
 public:
  SpatialChange(const sp::Scene& scene, const SpatialTwin& t)
      : t_(t),
        turn_(quaternions::exponential(t.turn).normalized()),
        R_(quaternions::matrix_of(turn_)),
        bodies_(static_cast<int>(scene.bodies.size())) {}

  Vector3d turned(const Vector3d& p) const { return t_.turn.isZero(0) ? p : Vector3d(R_ * p); }
  Eigen::Vector4d turned(const Eigen::Vector4d& p) const {
    return t_.turn.isZero(0) ? p : quaternions::product(turn_, p).normalized();
  }
  Vector3d world(const Vector3d& p) const { return t_.lambda * (turned(p) + t_.d); }
  BodyId id(BodyId b) const { return b >= 0 && t_.reversed ? bodies_ - 1 - b : b; }
  double speed() const { return t_.lambda / t_.tau; }
  double force() const { return t_.kappa * t_.lambda / (t_.tau * t_.tau); }
  double torque() const { return force() * t_.lambda; }
  double unit(const sp::Coordinate& c) const { return c.angle() ? 1 : t_.lambda; }

  /// Whatever of these fields an element of the bodies a and b has.
  template <class X> void pair(X& x) const {
    if constexpr (requires { x.point_a; }) point(x.a, x.point_a), point(x.b, x.point_b);
    if constexpr (requires { x.centre_a; }) point(x.a, x.centre_a), point(x.b, x.centre_b);
    if constexpr (requires { x.reference_a; })
      reference(x.a, x.axis_a, x.reference_a), reference(x.b, x.axis_b, x.reference_b);
    if constexpr (requires { x.axis_a; }) direction(x.a, x.axis_a), direction(x.b, x.axis_b);
    if constexpr (requires { x.axis; }) direction(x.a, x.axis);
    if constexpr (requires { x.plane_point; })
      point(x.a, x.centre), point(x.b, x.plane_point), direction(x.b, x.normal);
    if constexpr (requires {
                    x.orientation;
                    x.point_a;
                  }) {  // of b in a
      if (x.a < 0) x.orientation = turned(x.orientation);
      if (x.b < 0 && !t_.turn.isZero(0))
        x.orientation = quaternions::product(x.orientation, quaternions::inverse(turn_)).normalized();
    }
    for (double* length : lengths(x)) *length *= t_.lambda;
    if constexpr (requires { x.semi_axes; }) x.semi_axes *= t_.lambda;
    if constexpr (requires { x.law.surface; }) surface(x.b, x.law);
    x.a = id(x.a), x.b = id(x.b);
  }
  void coordinate(sp::Coordinate& c) const {
    std::visit([&](auto& x) { pair(x); }, static_cast<std::variant<sp::Angle, sp::Slide, sp::Span>&>(c));
  }

  void joint(sp::Drive& j) const {
    const double by = unit(j.of);
    j.law.offset *= by, j.law.amplitude *= by, j.law.rate_of_change *= by / t_.tau, j.law.omega /= t_.tau;
    coordinate(j.of);
  }
  void joint(sp::Gear& j) const {
    sp::Coordinate first = j.first, second = j.second;
    const double by = unit(second);
    coordinate(first), coordinate(second);
    j = sp::Gear(j.name, first, second, j.ratio * by / unit(j.first), j.offset * by);
  }
  void joint(auto& j) const { pair(j); }

  void contact(sp::Backlash& c) const { c.play *= unit(c.gear.second), joint(c.gear); }
  void contact(sp::Limit& c) const { c.bound *= unit(c.of), coordinate(c.of); }
  void contact(auto& c) const { pair(c); }

  void spring(sp::JointSpring& s) const {
    s.stiffness *= s.of.angle() ? torque() : force() / t_.lambda;
    s.damping *= s.of.angle() ? torque() * t_.tau : force() / speed();
    s.rest *= unit(s.of), coordinate(s.of);
  }
  void spring(sp::Drag& s) const {
    s.damping *= s.turning ? torque() * t_.tau : force() / speed(), s.point *= t_.lambda;
    s.quadratic *= s.turning ? torque() * t_.tau * t_.tau : force() / (speed() * speed());
    s.a = id(s.a), s.b = id(s.b);
  }
  void spring(sp::PointSpring& s) const {
    s.stiffness *= force() / t_.lambda, s.damping *= force() / speed(), s.rest *= t_.lambda, pair(s);
  }
  void load(sp::Load& l) const {
    l.point *= t_.lambda, l.force *= force(), l.moment *= torque(), l.body = id(l.body);
    if (l.frame == sp::Frame::world) l.force = turned(l.force), l.moment = turned(l.moment);
  }
  void collision(sp::Collision& c) const {
    for (sp::Shape& s : c.shapes) {
      for (Vector3d& corner : s.corners) point(s.body, corner);
      s.radius *= t_.lambda, s.hull = nullptr, s.body = id(s.body);
    }
    if (t_.reversed) std::reverse(c.shapes.begin(), c.shapes.end());
    for (auto& [a, b] : c.apart) a = id(a), b = id(b);
    c.law.surface.rolling *= t_.lambda, c.law.surface.spinning *= t_.lambda;
  }

 private:
  void point(BodyId b, Vector3d& p) const { p = b < 0 ? world(p) : Vector3d(t_.lambda * p); }
  void direction(BodyId b, Vector3d& n) const {
    if (b < 0) n = turned(n).normalized();
  }
  /// Before its axis is turned: what is taken where it is not given depends on the axis.
  void reference(BodyId b, const Vector3d& axis, Vector3d& given) const {
    if (b >= 0 || t_.turn.isZero(0)) return;
    given = turned(given.isZero(0) ? sp::perpendicular(axis) : given);
    const Vector3d u = turned(axis).normalized();
    given = (given - u.dot(given) * u).normalized();
  }
  void surface(BodyId b, ContactLaw& law) const {
    SurfaceLaw& s = law.surface;
    s.rolling *= t_.lambda, s.spinning *= t_.lambda, s.velocity *= speed(), s.omega /= t_.tau;
    if (s.moves()) point(b, s.centre);
    if (b < 0) s.velocity = turned(s.velocity), s.omega = turned(s.omega);
    if (b < 0 && s.orthotropic()) s.direction = turned(s.direction).normalized();
  }
  template <class X> static std::vector<double*> lengths(X& x) {
    std::vector<double*> all;
    if constexpr (requires { x.radius; }) all.push_back(&x.radius);
    if constexpr (requires { x.radius_a; }) all.push_back(&x.radius_a), all.push_back(&x.radius_b);
    if constexpr (requires { x.length; }) all.push_back(&x.length);
    if constexpr (requires { x.pitch; }) all.push_back(&x.pitch), all.push_back(&x.offset);
    if constexpr (requires { x.tube; }) all.push_back(&x.tube);
    if constexpr (requires { x.along; }) all.push_back(&x.along);
    return all;
  }

  const SpatialTwin& t_;
  Eigen::Vector4d turn_;
  Eigen::Matrix3d R_;
  int bodies_;
};

}  // namespace

spatial::Scene twin_of(const spatial::Scene& scene, const SpatialTwin& t) {
  const SpatialChange change(scene, t);
  sp::Scene s = scene;
  s.gravity = (1 + t.nudge) * t.lambda / (t.tau * t.tau) * change.turned(s.gravity);
  double part = 1;
  for (sp::Body& b : s.bodies) {
    const double off = 1 + t.nudge * (part = -0.8 * part - 0.3);  // another part for each
    b.mass *= t.kappa * off, b.inertia *= t.kappa * off * t.lambda * t.lambda;
    b.position = change.world(b.position) + t.nudge / 10 * Vector3d(part, 0.5 - part, 0.7 * part);
    b.orientation = change.turned(b.orientation);
    if (t.nudge != 0)
      b.orientation = quaternions::turned(b.orientation, t.nudge / 10 * Vector3d(part, 0.3 + part, -0.6 * part));
    b.velocity = (1 + t.nudge) * change.speed() * change.turned(b.velocity);
    b.omega = (1 + t.nudge) / t.tau * change.turned(b.omega);
  }
  for (sp::Joint& j : s.joints) std::visit([&](auto& x) { change.joint(x); }, j);
  for (sp::Contact& c : s.contacts) std::visit([&](auto& x) { change.contact(x); }, c);
  for (sp::Collision& c : s.collisions) change.collision(c);
  for (sp::Spring& x : s.springs) std::visit([&](auto& y) { change.spring(y); }, x);
  for (sp::JointFriction& f : s.frictions)
    f.bound *= f.of.angle() ? change.torque() : change.force(), change.coordinate(f.of);
  for (sp::Load& l : s.loads) change.load(l);
  s.duration *= t.tau, s.step *= t.tau;
  if (t.reversed) {
    std::reverse(s.bodies.begin(), s.bodies.end()), std::reverse(s.joints.begin(), s.joints.end());
    std::reverse(s.contacts.begin(), s.contacts.end()), std::reverse(s.springs.begin(), s.springs.end());
    std::reverse(s.loads.begin(), s.loads.end()), std::reverse(s.frictions.begin(), s.frictions.end());
  }
  return s;
}

Eigen::VectorXd back(const SpatialTwin& t, const Eigen::VectorXd& q) {
  Eigen::VectorXd original(q.size());
  const Eigen::Index n = q.size() / 7;
  const Eigen::Vector4d turn = quaternions::exponential(t.turn).normalized();
  const Eigen::Matrix3d R = quaternions::matrix_of(turn);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index from = 7 * (t.reversed ? n - 1 - i : i);
    const Vector3d p = q.segment<3>(from) / t.lambda - t.d;
    original.segment<3>(7 * i) = R.transpose() * p;
    original.segment<4>(7 * i + 3) = quaternions::product(quaternions::inverse(turn), q.segment<4>(from + 3));
  }
  return original;
}

}  // namespace orthant::motion_storm
