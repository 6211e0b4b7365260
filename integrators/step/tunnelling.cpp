#include <orthant/core/mechanics/planar/relation.h>
#include <orthant/integrators/step/polygon_points.h>
#include <orthant/integrators/step/tunnelling.h>
#include <orthant/integrators/step/width.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kDeep = 0.05;        // of the thinner shape: they met
constexpr double kStride = 1.0 / 16;  // likewise: a stride along the way
constexpr double kNear = 0.4;         // likewise: the ends of a shorter way are at most half of it from its middle
constexpr double kNudge = 1e-6;       // likewise: small against what curves a gap, large against its rounding

double reach_of(const Polygon& corners) {
  double most = 0;
  for (const Vector2d& corner : corners) most = std::max(most, corner.norm());
  return most;
}

}  // namespace

TunnellingDetector::TunnellingDetector(const System& system)
    : system_(system),
      pin_(static_cast<std::size_t>(system.bodies())),
      reach_(static_cast<std::size_t>(system.bodies())),
      way_(reach_.size()),
      least_(std::numeric_limits<double>::infinity()) {
  const auto reaches = [&](BodyId body, double reach) {
    if (body >= 0) reach_[static_cast<std::size_t>(body)] = std::max(reach_[static_cast<std::size_t>(body)], reach);
  };
  const auto disc = [&](BodyId body, const Vector2d& centre, double radius) {
    reaches(body, centre.norm() + radius);
    return 2 * radius;
  };
  const auto polygon = [&](BodyId body, const Polygon& corners) {
    reaches(body, reach_of(corners));
    return width_of(corners);
  };
  const auto add = [&](int contact, double one, double other) { listed_.push_back({contact, std::min(one, other)}); };
  const auto& contacts = system.scene().contacts;
  for (int i = 0; i < static_cast<int>(contacts.size()); ++i) {
    const Contact& contact = contacts[static_cast<std::size_t>(i)];
    if (const auto* c = std::get_if<DiscDisc>(&contact))
      add(i, disc(c->a, c->centre_a, c->radius_a), disc(c->b, c->centre_b, c->radius_b));
    else if (const auto* d = std::get_if<DiscPolygon>(&contact))
      add(i, disc(d->a, d->centre, d->radius), polygon(d->b, d->corners));
    else if (const auto* p = std::get_if<PolygonPolygon>(&contact))
      add(i, polygon(p->a, p->corners_a), polygon(p->b, p->corners_b));
    else if (const auto* limit = std::get_if<Limit>(&contact); limit && limit->side == Limit::Side::lower)
      if (const auto* span = std::get_if<Span>(&limit->of.kind()); span && limit->bound > 0) {
        disc(span->a, span->point_a, 0), disc(span->b, span->point_b, 0);
        add(i, limit->bound, limit->bound);
      }
    if (const auto* custom = std::get_if<CustomContact>(&contact); custom != nullptr)
      if (const auto* bound = custom->target<RelationLimit>(); bound != nullptr)
        for (const CoordinateTerm& term : bound->sum.terms()) {  // grows on both sides of a distance that becomes 0
          const auto* span = std::get_if<Span>(&term.of.kind());
          if (span == nullptr || (term.factor > 0) != (bound->side == Limit::Side::lower)) continue;
          const double width = std::abs(bound->bound);
          if (!(width > 0)) continue;
          disc(span->a, span->point_a, 0), disc(span->b, span->point_b, 0);
          add(i, width, width);
          break;
        }
  }
  const auto pinned = [&](BodyId body, const Vector2d& place, const Vector2d& point) {
    if (body >= 0) pin_[static_cast<std::size_t>(body)] = {true, place, point};
  };
  for (const Joint& joint : system.scene().joints)
    if (const auto* pin = std::get_if<Revolute>(&joint)) {
      if (pin->a < 0) pinned(pin->b, pin->point_a, pin->point_b);
      if (pin->b < 0) pinned(pin->a, pin->point_b, pin->point_a);
    }
  for (const Shapes& pair : listed_) least_ = std::min(least_, pair.width);
  for (const Collision& c : system.scene().collisions) {
    auto& widths = width_.emplace_back();
    for (const Shape& s : c.shapes)
      widths.push_back(s.corners.empty() ? disc(s.body, s.centre, s.radius) : polygon(s.body, s.corners));
    for (const double width : widths) least_ = std::min(least_, width);
  }
  at_.pose.resize(reach_.size() + 1);
}

/// [m] No point of the body's shapes goes farther.
double TunnellingDetector::way_of(BodyId body, const Eigen::VectorXd& q, const Eigen::VectorXd& q_end) const {
  const auto step = between(q, q_end);
  const double turn = std::abs(rotation(step, body));
  const double shift = std::hypot(step[kBlock * body], step[kBlock * body + 1]);
  const auto i = static_cast<std::size_t>(body);
  if (!pin_[i].is) return shift + reach_[i] * turn;
  return std::min(shift, turn * pin_[i].point.norm()) + turn * (pin_[i].point.norm() + reach_[i]);
}

/// The body at s ∈ [0, 1] of its way.
void TunnellingDetector::place(BodyId body, const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, double s) {
  const auto posed = [&](const auto& at) -> Pose {
    const double theta = rotation(at, body);
    return {translation(at, body), theta, std::cos(theta), std::sin(theta)};
  };
  const auto i = static_cast<std::size_t>(body);
  Pose& pose = at_.pose[i];
  pose = posed(q + s * between(q, q_end));
  if (!pin_[i].is) return;
  const auto off = [&](const Pose& p) -> Vector2d { return p.x + p.turn(pin_[i].point) - pin_[i].place; };
  const Vector2d from = off(posed(q)), to = off(posed(q_end));
  pose.x = pin_[i].place - pose.turn(pin_[i].point) + from + s * (to - from);
}

Passage TunnellingDetector::look(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms) {
  double farthest = 0;
  for (std::size_t i = 0; i < way_.size(); ++i) {
    way_[i] = way_of(static_cast<BodyId>(i), q, q_end);
    farthest = std::max(farthest, way_[i]);
  }
  if (2 * farthest <= kNear * least_) return {};
  const auto way = [&](BodyId body) { return body < 0 ? 0 : way_[static_cast<std::size_t>(body)]; };
  const auto found = [&](const Shapes& pair) -> Passage {
    auto [a, b] = bodies_of(system_, terms.pairs, pair.contact);
    const double together = way(a) + way(b);
    if (!passed(q, q_end, terms, pair, a, b, together)) return {};
    if (way(a) < way(b)) std::swap(a, b);
    return {a, b, way(a), pair.width};
  };
  for (const Shapes& pair : listed_)
    if (const Passage p = found(pair); p.width > 0) return p;
  for (std::size_t i = 0; i < terms.pairs.size(); ++i) {
    const Pair& pair = terms.pairs[i];
    if (pair.none()) continue;
    const auto& widths = width_[static_cast<std::size_t>(pair.collision)];
    const double width = std::min(widths[static_cast<std::size_t>(pair.a)], widths[static_cast<std::size_t>(pair.b)]);
    if (const Passage p = found({system_.listed() + static_cast<int>(i), width}); p.width > 0) return p;
  }
  return {};
}

/// Of two polygons the smaller one of both points.
double TunnellingDetector::gap(const std::vector<Pair>& pairs, int contact) const {
  const auto both = polygon_points(system_, pairs, contact, at_);
  if (!both) return gap_of(system_, pairs, contact, at_);
  double least = std::numeric_limits<double>::infinity();
  for (const Touch& point : *both)
    least = std::min(least, std::visit([&](const auto& c) { return c.gap(at_); }, point));
  return least;
}

bool TunnellingDetector::passed(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms,
                                const Shapes& pair, BodyId a, BodyId b, double way) {
  if (!(way > kNear * pair.width) || !std::isfinite(way)) return false;
  const auto along = [&](double s) {
    for (const BodyId body : {a, b})
      if (body >= 0) place(body, q, q_end, s);
    return gap(terms.pairs, pair.contact);
  };
  const double end = along(1), start = along(0), met = -kDeep * pair.width, deep = std::min({start, end, 0.0}) + met;
  if (end > met && (start + end - way) / 2 > deep) return false;
  const auto normal = [&](double s) -> Vector2d {  // the gap's gradient
    const BodyId moved = a >= 0 ? a : b;
    const double by = kNudge * pair.width;
    const auto slope = [&](Index k) {
      along(s);
      double& x = at_.pose[static_cast<std::size_t>(moved)].x[k];
      x += by;
      const double ahead = gap(terms.pairs, pair.contact);
      x -= 2 * by;
      return ahead - gap(terms.pairs, pair.contact);
    };
    return {slope(0), slope(1)};
  };
  double meeting = 1;
  for (double s = 0, now = start; s < 1; now = along(s)) {
    if (now <= deep) return true;
    if (now <= met) meeting = std::min(meeting, s);
    s += std::max(now, kStride * pair.width) / way;
  }
  if (end > met || meeting >= 1) return false;
  const Vector2d out = normal(1);  // twice the nudge, but none in the very middle, where no side is left
  return out.norm() < kNudge * pair.width || normal(meeting).dot(out) < 0;
}

}  // namespace orthant
