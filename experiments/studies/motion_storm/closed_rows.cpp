#include "experiments/studies/motion_storm/closed_rows.h"

#include "experiments/studies/motion_storm/measure.h"
#include "experiments/studies/motion_storm/place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace orthant::motion_storm {
namespace {

using Eigen::VectorXd;
constexpr double kEndlessly = std::numeric_limits<double>::infinity();

class PlanarRows {
 public:
  PlanarRows(const Scene& scene, const State& x, double most) : scene_(scene), x_(x), most_(most) {
    rows_.inverse_mass.resize(static_cast<Eigen::Index>(3 * scene.bodies.size()));
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
      rows_.inverse_mass.segment<3>(static_cast<Eigen::Index>(3 * b)) << 1 / scene.bodies[b].mass,
          1 / scene.bodies[b].mass, 1 / scene.bodies[b].inertia;
  }

  ClosedRows all() {
    for (const Joint& joint : scene_.joints) std::visit(*this, joint);
    for (const Contact& contact : scene_.contacts) {
      std::visit([this](const auto& c) { law_ = c.law; }, contact);
      std::visit(*this, contact);
      ++contact_;
    }
    return std::move(rows_);
  }

  void operator()(const Revolute& j) { joined(j); }
  void operator()(const Fixed& j) { joined(j), rows_.joints.push_back(turning(j.a, j.b)); }
  void operator()(const Prismatic& j) {
    const Vector2d across = at_.turn(j.a, Vector2d(-j.axis.y(), j.axis.x()));
    rows_.joints.push_back(along(j.b, j.a, across, at_.at(j.b, j.point_b)));
    rows_.joints.push_back(turning(j.b, j.a));
  }
  void operator()(const Distance& j) { rows_.joints.push_back(stretch(j.a, j.point_a, j.b, j.point_b)); }
  void operator()(const Drive& j) { rows_.joints.push_back(row_of(j.of)); }
  void operator()(const CustomJoint& j) {
    if (const auto* relation = j.target<Relation>()) rows_.joints.push_back(row_of(relation->sum));
  }

  void operator()(const CornerWall& c) {
    touch(c.a, c.b, at_.turn(c.b, c.normal), at_.at(c.a, c.point), at_.at(c.b, c.wall_point));
  }
  void operator()(const DiscWall& c) {
    const Vector2d n = at_.turn(c.b, c.normal);
    touch(c.a, c.b, n, at_.at(c.a, c.centre) - c.radius * n, at_.at(c.b, c.wall_point));
  }
  void operator()(const DiscDisc& c) {
    const Vector2d a = at_.at(c.a, c.centre_a), b = at_.at(c.b, c.centre_b), n = (a - b).normalized();
    touch(c.a, c.b, n, a - c.radius_a * n, b + c.radius_b * n);
  }
  void operator()(const Journal& c) {
    const Vector2d a = at_.at(c.a, c.centre_a), b = at_.at(c.b, c.centre_b), n = (b - a).normalized();
    if (a == b) return;  // no direction, and a clearance
    touch(c.a, c.b, n, a - c.radius_a * n, b - c.radius_b * n);
  }
  void operator()(const DiscPolygon& c) {
    const Vector2d centre = at_.at(c.a, c.centre);
    const Polygon p = at_.at(c.b, c.corners);
    double nearest = kEndlessly, beyond = -kEndlessly;
    Vector2d foot(0, 0), out(0, 0);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vector2d side = p[(i + 1) % p.size()] - p[i], from = centre - p[i];
      const Vector2d x = p[i] + std::clamp(from.dot(side) / side.squaredNorm(), 0.0, 1.0) * side;
      if ((centre - x).norm() < nearest) nearest = (centre - x).norm(), foot = x;
      const Vector2d n = Vector2d(side.y(), -side.x()).normalized();
      if (n.dot(from) > beyond) beyond = n.dot(from), out = n;
    }
    const Vector2d n = beyond > 0 ? Vector2d((centre - foot).normalized()) : out;
    if (beyond <= 0) foot = centre - beyond * n;
    touch(c.a, c.b, n, centre - c.radius * n, foot);
  }
  void operator()(const PolygonPolygon& c) {
    if (c.point != 0) return;  // the first stands for both
    const Polygon a = at_.at(c.a, c.corners_a), b = at_.at(c.b, c.corners_b);
    const Face of_a = farthest(a, b), of_b = farthest(b, a);
    const bool on_a = of_a.beyond > of_b.beyond;
    const Polygon &p = on_a ? a : b, &r = on_a ? b : a;
    const std::size_t i = (on_a ? of_a : of_b).number, k = facing(r, outward_of(p, i));
    const std::pair corner_of_r{on_a ? c.b : c.a, !on_a}, corner_of_p{on_a ? c.a : c.b, on_a};
    ends_over(p, i, r, k, corner_of_r, corner_of_p.first, most_);
    ends_over(r, k, p, i, corner_of_p, corner_of_r.first, -most_);
  }
  void operator()(const Limit& c) { limit(c.of, c.side, c.bound); }
  void operator()(const CustomContact& c) {
    if (const auto* of = c.target<RelationLimit>()) limit(of->sum, of->side, of->bound);
  }

 private:
  struct Face {
    double beyond = -kEndlessly;
    std::size_t number = 0;
  };

  template <class Of> void limit(const Of& of, Limit::Side side, double bound) {
    const double value = at_.value(of), gap = side == Limit::Side::lower ? value - bound : bound - value;
    if (gap > most_) return;
    const VectorXd row = row_of(of) * (side == Limit::Side::lower ? 1 : -1);
    add(row, VectorXd::Zero(row.size()), gap);
  }
  VectorXd row_of(const CoordinateSum& sum) const {
    VectorXd row = VectorXd::Zero(rows_.inverse_mass.size());
    for (const CoordinateTerm& term : sum.terms()) row += term.factor * row_of(term.of);
    return row;
  }

  static Vector2d outward_of(const Polygon& p, std::size_t i) {
    const Vector2d side = p[(i + 1) % p.size()] - p[i];
    return Vector2d(side.y(), -side.x()).normalized();
  }
  static Face farthest(const Polygon& p, const Polygon& r) {
    Face best;
    for (std::size_t i = 0; i < p.size(); ++i) {
      double least = kEndlessly;
      for (const Vector2d& corner : r) least = std::min(least, outward_of(p, i).dot(corner - p[i]));
      if (least > best.beyond) best = {least, i};
    }
    return best;
  }
  /// The face of r that is turned against n most.
  static std::size_t facing(const Polygon& r, const Vector2d& n) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < r.size(); ++k)
      if (outward_of(r, k).dot(n) < outward_of(r, best).dot(n)) best = k;
    return best;
  }
  /// Ends of face k of r that stand over face i of p, which goes on by `margin` [m] at both ends. `corner`: r's body,
  /// and whether it is the contact's a; `face`: p's body.
  void ends_over(const Polygon& p, std::size_t i, const Polygon& r, std::size_t k,
                 const std::pair<BodyId, bool>& corner, BodyId face, double margin) {
    const Vector2d n = outward_of(p, i), side = p[(i + 1) % p.size()] - p[i];
    for (const std::size_t j : {k, (k + 1) % r.size()}) {
      const double part = (r[j] - p[i]).dot(side) / side.squaredNorm();
      const double slack = margin / side.norm();
      if (part < -slack || part > 1 + slack) continue;
      const Vector2d foot = p[i] + part * side;
      if (corner.second)
        touch(corner.first, face, n, r[j], foot);
      else
        touch(face, corner.first, -n, foot, r[j]);
    }
  }

  /// Row along u of a's point at P against b's.
  VectorXd along(BodyId a, BodyId b, const Vector2d& u, const Vector2d& P) const { return along(a, P, b, P, u); }
  VectorXd along(BodyId a, const Vector2d& P_a, BodyId b, const Vector2d& P_b, const Vector2d& u) const {
    VectorXd row = VectorXd::Zero(rows_.dof());
    for (const auto& [body, P, sign] : {std::tuple{a, P_a, 1.0}, std::tuple{b, P_b, -1.0}}) {
      if (body < 0) continue;
      const Vector2d r = P - x_.q.segment<2>(3 * body);
      row.segment<3>(3 * body) += sign * Eigen::Vector3d(u.x(), u.y(), u.y() * r.x() - u.x() * r.y());
    }
    return row;
  }
  VectorXd turning(BodyId a, BodyId b) const {
    VectorXd row = VectorXd::Zero(rows_.dof());
    if (a >= 0) row[3 * a + 2] += 1;
    if (b >= 0) row[3 * b + 2] -= 1;
    return row;
  }
  VectorXd stretch(BodyId a, const Vector2d& point_a, BodyId b, const Vector2d& point_b) const {
    const Vector2d P_a = at_.at(a, point_a), P_b = at_.at(b, point_b);
    return along(a, P_a, b, P_b, (P_a - P_b).normalized());
  }
  VectorXd row_of(const Coordinate& of) const {
    if (const auto* angle = std::get_if<Angle>(&of)) return turning(angle->b, angle->a);
    if (const auto* s = std::get_if<Slide>(&of))
      return along(s->b, s->a, at_.turn(s->a, s->axis), at_.at(s->b, s->point_b));
    const auto& d = std::get<Span>(of);
    return stretch(d.a, d.point_a, d.b, d.point_b);
  }
  void joined(const auto& j) {
    const Vector2d P_a = at_.at(j.a, j.point_a), P_b = at_.at(j.b, j.point_b);
    for (const Vector2d& u : {Vector2d(1, 0), Vector2d(0, 1)}) rows_.joints.push_back(along(j.a, P_a, j.b, P_b, u));
  }

  /// A contact of a's point P_a with b's point P_b, n from b to a.
  void touch(BodyId a, BodyId b, const Vector2d& n, const Vector2d& P_a, const Vector2d& P_b) {
    const double gap = n.dot(P_a - P_b);
    if (gap > most_) return;
    add(along(a, P_a, b, P_a, n), along(a, P_a, b, P_a, Vector2d(n.y(), -n.x())), gap);
  }
  void add(VectorXd normal, VectorXd tangent, double gap) {
    const VectorXd slip = VectorXd::Constant(1, tangent.dot(x_.v) - law_.belt);
    rows_.contacts.push_back({contact_, law_, gap, std::move(normal), {std::move(tangent)}, {VectorXd::Ones(1)}, slip});
  }

  const Scene& scene_;
  const State& x_;
  const double most_;
  const Place at_{x_.q};
  ClosedRows rows_;
  ContactLaw law_;   // of the contact in hand
  int contact_ = 0;  // its number
};

}  // namespace

ClosedRows closed_rows(const Scene& scene, const State& x, double gap) { return PlanarRows(scene, x, gap).all(); }

}  // namespace orthant::motion_storm
