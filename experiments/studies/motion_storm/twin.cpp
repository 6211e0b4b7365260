#include "experiments/studies/motion_storm/twin.h"

#include <orthant/core/mechanics/planar/relation.h>

#include <algorithm>
#include <cmath>

namespace orthant::motion_storm {
namespace {

class Change {
 public:
  Change(const Scene& scene, const Twin& t) : t_(t), bodies_(static_cast<int>(scene.bodies.size())) {}

  Vector2d turned(const Vector2d& p) const {
    const double c = std::cos(t_.phi), s = std::sin(t_.phi), x = t_.m * p.x();
    return t_.phi == 0 ? Vector2d(x, p.y()) : Vector2d(c * x - s * p.y(), s * x + c * p.y());
  }
  Vector2d world(const Vector2d& p) const { return t_.lambda * (turned(p) + t_.d); }
  BodyId id(BodyId b) const { return b >= 0 && t_.reversed ? bodies_ - 1 - b : b; }
  void point(BodyId b, Vector2d& p) const {
    p = b < 0 ? world(p) : Vector2d(t_.lambda * t_.m * p.x(), t_.lambda * p.y());
  }
  void direction(BodyId b, Vector2d& n) const { n = b < 0 ? turned(n) : Vector2d(t_.m * n.x(), n.y()); }
  void corners(BodyId b, Polygon& p) const {
    for (Vector2d& corner : p) point(b, corner);
    if (t_.m < 0) std::reverse(p.begin(), p.end());
  }
  /// Of θ_of − θ_from.
  double angle(double value, BodyId of, BodyId from) const {
    return t_.m * value + ((of < 0 ? 0 : t_.phi) - (from < 0 ? 0 : t_.phi));
  }
  double speed() const { return t_.lambda / t_.tau; }
  double force() const { return t_.kappa * t_.lambda / (t_.tau * t_.tau); }
  double torque() const { return force() * t_.lambda; }

  /// A coordinate into its twin; `flips`: an angle whose sign has changed.
  void coordinate(Coordinate& c) const {
    std::visit(
        [&](auto& x) {
          if constexpr (requires { x.axis; }) direction(x.a, x.axis);
          if constexpr (requires { x.point_a; }) point(x.a, x.point_a), point(x.b, x.point_b);
          x.a = id(x.a), x.b = id(x.b);
        },
        static_cast<std::variant<Angle, Slide, Span>&>(c));
  }
  double value(const Coordinate& c, double v) const {  // before the coordinate is changed
    if (const auto* a = std::get_if<Angle>(&c)) return angle(v, a->b, a->a);
    return t_.lambda * v;
  }
  double rate(const Coordinate& c, double v) const {
    return (std::holds_alternative<Angle>(c) ? t_.m : t_.lambda) * v / t_.tau;
  }
  double span(const Coordinate& c, double v) const { return (std::holds_alternative<Angle>(c) ? t_.m : t_.lambda) * v; }

  void joint(Revolute& j) const { ends(j); }
  void joint(Prismatic& j) const { j.angle = angle(j.angle, j.b, j.a), direction(j.a, j.axis), ends(j); }
  void joint(Fixed& j) const { j.angle = angle(j.angle, j.a, j.b), ends(j); }
  void joint(Distance& j) const { j.length *= t_.lambda, ends(j); }
  void joint(Drive& j) const {
    j.law.offset = value(j.of, j.law.offset), j.law.rate_of_change = rate(j.of, j.law.rate_of_change);
    j.law.amplitude = span(j.of, j.law.amplitude), j.law.omega /= t_.tau;
    coordinate(j.of);
  }
  void joint(CustomJoint& j) const {
    const auto* relation = j.target<Relation>();
    if (relation == nullptr) return;
    double offset = relation->offset;
    const std::vector<CoordinateTerm> terms = of_sum(relation->sum, offset);
    j = Relation(j.name, terms, offset);
  }
  /// Of a sum and its value, both in units of length.
  std::vector<CoordinateTerm> of_sum(const CoordinateSum& sum, double& value_) const {
    std::vector<CoordinateTerm> terms = sum.terms();
    value_ *= t_.lambda;
    for (CoordinateTerm& term : terms) {
      const double factor = t_.lambda * term.factor / span(term.of, 1);
      value_ += factor * value(term.of, 0);
      coordinate(term.of), term.factor = factor;
    }
    return terms;
  }

  void contact(CornerWall& c) const { point(c.a, c.point), point(c.b, c.wall_point), direction(c.b, c.normal), law(c); }
  void contact(DiscWall& c) const {
    point(c.a, c.centre), c.radius *= t_.lambda, point(c.b, c.wall_point), direction(c.b, c.normal), law(c);
  }
  void contact(DiscDisc& c) const { discs(c); }
  void contact(Journal& c) const { discs(c); }
  void contact(DiscPolygon& c) const { point(c.a, c.centre), c.radius *= t_.lambda, corners(c.b, c.corners), law(c); }
  void contact(PolygonPolygon& c) const { corners(c.a, c.corners_a), corners(c.b, c.corners_b), law(c); }
  void contact(Limit& c) const {
    if (std::holds_alternative<Angle>(c.of) && t_.m < 0)
      c.side = c.side == Limit::Side::lower ? Limit::Side::upper : Limit::Side::lower;
    c.bound = value(c.of, c.bound);
    coordinate(c.of);
  }
  void contact(CustomContact& c) const {
    const auto* limit = c.target<RelationLimit>();
    if (limit == nullptr) return;
    double bound = limit->bound;
    const std::vector<CoordinateTerm> terms = of_sum(limit->sum, bound);
    c = RelationLimit(c.name, terms, limit->side, bound, limit->law.e);
  }

  void spring(PointSpring& s) const {
    s.stiffness *= force() / t_.lambda, s.damping *= force() / speed(), s.rest *= t_.lambda, ends(s);
  }
  void spring(TorsionSpring& s) const {
    s.stiffness *= torque(), s.damping *= torque() * t_.tau, s.rest = angle(s.rest, s.a, s.b);
    s.a = id(s.a), s.b = id(s.b);
  }
  void spring(JointSpring& s) const {
    const bool turns = std::holds_alternative<Angle>(s.of);
    s.stiffness *= turns ? torque() : force() / t_.lambda, s.damping *= turns ? torque() * t_.tau : force() / speed();
    s.rest = value(s.of, s.rest);
    coordinate(s.of);
  }

 private:
  void ends(auto& x) const { point(x.a, x.point_a), point(x.b, x.point_b), x.a = id(x.a), x.b = id(x.b); }
  void discs(auto& c) const {
    point(c.a, c.centre_a), point(c.b, c.centre_b), c.radius_a *= t_.lambda, c.radius_b *= t_.lambda, law(c);
  }
  void law(auto& c) const { c.law.belt *= t_.m * speed(), c.a = id(c.a), c.b = id(c.b); }

  const Twin& t_;
  int bodies_;
};

}  // namespace

Scene twin_of(const Scene& scene, const Twin& t) {
  const Change change(scene, t);
  Scene s = scene;
  s.gravity = (1 + t.nudge) * t.lambda / (t.tau * t.tau) * change.turned(s.gravity);
  double part = 1;
  for (Body& b : s.bodies) {
    const double off = 1 + t.nudge * (part = -0.8 * part - 0.3);  // another part for each
    b.mass *= t.kappa * off, b.inertia *= t.kappa * off * t.lambda * t.lambda;
    b.position = change.world(b.position) + t.nudge / 10 * Vector2d(part, 0.5 - part);
    b.angle = t.m * b.angle + t.phi + t.nudge / 10 * part;
    b.velocity = (1 + t.nudge) * change.speed() * change.turned(b.velocity), b.omega *= (1 + t.nudge) * t.m / t.tau;
  }
  for (Joint& j : s.joints) std::visit([&](auto& x) { change.joint(x); }, j);
  for (Contact& c : s.contacts) std::visit([&](auto& x) { change.contact(x); }, c);
  for (Spring& x : s.springs) std::visit([&](auto& y) { change.spring(y); }, x);
  for (Load& l : s.loads) {
    change.point(0, l.point), l.force = change.force() * change.turned(l.force), l.torque *= t.m * change.torque();
    l.body = change.id(l.body);
  }
  s.duration *= t.tau, s.step *= t.tau;
  if (t.reversed) {
    std::reverse(s.bodies.begin(), s.bodies.end()), std::reverse(s.joints.begin(), s.joints.end());
    std::reverse(s.contacts.begin(), s.contacts.end()), std::reverse(s.springs.begin(), s.springs.end());
    std::reverse(s.loads.begin(), s.loads.end());
  }
  return s;
}

Eigen::VectorXd back(const Twin& t, const Eigen::VectorXd& q) {
  Eigen::VectorXd original(q.size());
  const Eigen::Index n = q.size() / 3;
  const double c = std::cos(t.phi), s = std::sin(t.phi);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index from = 3 * (t.reversed ? n - 1 - i : i);
    const Vector2d p = q.segment<2>(from) / t.lambda - t.d;
    original[3 * i] = t.m * (t.phi == 0 ? p.x() : c * p.x() + s * p.y());
    original[3 * i + 1] = t.phi == 0 ? p.y() : c * p.y() - s * p.x();
    original[3 * i + 2] = t.m * (q[from + 2] - t.phi);
  }
  return original;
}

}  // namespace orthant::motion_storm
