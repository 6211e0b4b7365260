#include <orthant/integrators/step/tunnelling.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kDeep = 0.05;        // of the thinner shape: they met
constexpr double kStride = 1.0 / 16;  // likewise: a stride along the way
constexpr double kNear = 0.5;         // likewise: no less has to be moved, to pass

double reach_of(const Polygon& corners) {
  double most = 0;
  for (const Vector2d& corner : corners) most = std::max(most, corner.norm());
  return most;
}

/// Between parallel lines, the nearest that have the polygon between them.
double width_of(const Polygon& corners) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d& from = corners[i];
    const Vector2d n = perp(corners[(i + 1) % corners.size()] - from).normalized();
    double high = 0;
    for (const Vector2d& corner : corners) high = std::max(high, std::abs(n.dot(corner - from)));
    least = std::min(least, high);
  }
  return least;
}

}  // namespace

Passing::Passing(const System& system)
    : system_(system),
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

Passage Passing::look(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms) {
  double farthest = 0;
  for (std::size_t i = 0; i < way_.size(); ++i) {
    const auto d = [&](Index k) { return q_end[3 * static_cast<Index>(i) + k] - q[3 * static_cast<Index>(i) + k]; };
    way_[i] = std::hypot(d(0), d(1)) + reach_[i] * std::abs(d(2));
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

bool Passing::passed(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end, const Terms& terms, const Shapes& pair,
                     BodyId a, BodyId b, double way) {
  const double end = terms.gap[pair.contact], deep = -kDeep * pair.width;
  if (!(way > kNear * pair.width) || !(end > deep && end < way) || !std::isfinite(way)) return false;
  const auto gap = [&](double s) {
    for (const BodyId body : {a, b}) {
      if (body < 0) continue;
      const Index i = 3 * body;
      const auto at = [&](Index k) { return q[i + k] + s * (q_end[i + k] - q[i + k]); };
      at_.pose[static_cast<std::size_t>(body)] = {{at(0), at(1)}, at(2), std::cos(at(2)), std::sin(at(2))};
    }
    return gap_of(system_, terms.pairs, pair.contact, at_);
  };
  double now = gap(0);
  if (!(now > deep)) return false;
  for (double s = 0; s < 1; now = gap(s)) {
    if (now <= deep) return true;
    s += std::max(now, kStride * pair.width) / way;
  }
  return false;
}

}  // namespace orthant
