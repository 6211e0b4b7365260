#include <orthant/integrators/step/spatial_tunnelling.h>
#include <orthant/integrators/step/width.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kMetDepth = 0.05;       // of the thinner shape: they met
constexpr double kWayStride = 1.0 / 16;  // likewise: a stride along the way
constexpr double kShortWay = 0.4;        // likewise: the ends of a shorter way are at most half of it from its middle

}  // namespace

SpatialTunnellingDetector::SpatialTunnellingDetector(const SystemOf<Spatial>& system)
    : system_(system),
      collisions_(system.scene().collisions),
      reach_(static_cast<std::size_t>(system.bodies())),
      way_(reach_.size()) {
  for (const spatial::Contact& contact : system.scene().contacts)
    if (const auto* c = std::get_if<spatial::SphereSphere>(&contact))
      collisions_.push_back(
          {c->name, {{c->a, {c->centre_a}, c->radius_a}, {c->b, {c->centre_b}, c->radius_b}}, c->law, 1});
  least_ = std::numeric_limits<double>::infinity();
  for (const spatial::Collision& c : collisions_) {
    auto& widths = width_.emplace_back();
    for (const spatial::Shape& s : c.shapes) {
      widths.push_back(width_of(s));
      least_ = std::min(least_, widths.back());
      if (s.body < 0) continue;
      double& reach = reach_[static_cast<std::size_t>(s.body)];
      for (const Vector3d& corner : s.corners) reach = std::max(reach, corner.norm() + s.radius);
    }
  }
}

spatial::TouchPoint SpatialTunnellingDetector::at(const Eigen::VectorXd& q, const spatial::Shape& a,
                                                  const spatial::Shape& b, double s) {
  const auto posed = [&](BodyId body) {
    spatial::Pose pose;
    if (body < 0) return pose;
    pose.x = place_of<Spatial>(q, body) + s * translation<Spatial>(step_, body);
    pose.axes =
        quaternions::matrix_of(quaternions::turned(quaternion(q, body), Vector3d(s * rotation<Spatial>(step_, body))));
    pose.R = pose.axes * system_.scene().bodies[static_cast<std::size_t>(body)].to_axes;
    return pose;
  };
  const spatial::TouchPoints points = touch(posed(a.body), a, posed(b.body), b);
  spatial::TouchPoint least{.gap = std::numeric_limits<double>::infinity()};
  for (int i = 0; i < points.count; ++i)
    if (const auto& p = points.points[static_cast<std::size_t>(i)]; p.gap < least.gap) least = p;
  return least;
}

Passage SpatialTunnellingDetector::look(const Eigen::VectorXd& q, const Eigen::VectorXd& q_end,
                                        const TermsOf<Spatial>& terms) {
  step_ = between<Spatial>(q, q_end);
  double farthest = 0;
  for (std::size_t i = 0; i < way_.size(); ++i) {
    const auto body = static_cast<Eigen::Index>(i);
    way_[i] = translation<Spatial>(step_, body).norm() + reach_[i] * rotation<Spatial>(step_, body).norm();
    farthest = std::max(farthest, way_[i]);
  }
  if (2 * farthest <= kShortWay * least_) return {};
  const auto found = [&](std::size_t collision, int a, int b) -> Passage {
    const spatial::Shape &x = collisions_[collision].shapes[static_cast<std::size_t>(a)],
                         &y = collisions_[collision].shapes[static_cast<std::size_t>(b)];
    const auto& widths = width_[collision];
    const double width = std::min(widths[static_cast<std::size_t>(a)], widths[static_cast<std::size_t>(b)]);
    if (!passed(q, x, y, width, way_of(x.body) + way_of(y.body))) return {};
    const bool first = way_of(x.body) >= way_of(y.body);
    return {first ? x.body : y.body, first ? y.body : x.body, way_of(first ? x.body : y.body), width};
  };
  for (std::size_t c = system_.scene().collisions.size(); c < collisions_.size(); ++c)
    if (const Passage p = found(c, 0, 1); p.width > 0) return p;
  for (const Pair& pair : terms.pairs) {
    if (pair.none() || pair.point > 0) continue;
    if (const Passage p = found(static_cast<std::size_t>(pair.collision), pair.a, pair.b); p.width > 0) return p;
  }
  return {};
}

bool SpatialTunnellingDetector::passed(const Eigen::VectorXd& q, const spatial::Shape& a, const spatial::Shape& b,
                                       double width, double way) {
  if (!(way > kShortWay * width) || !std::isfinite(way)) return false;
  const spatial::TouchPoint end = at(q, a, b, 1), start = at(q, a, b, 0);
  const double met = -kMetDepth * width, deep = std::min({start.gap, end.gap, 0.0}) + met;
  if (end.gap > met && (start.gap + end.gap - way) / 2 > deep) return false;
  Vector3d normal(0, 0, 0);  // where they met
  spatial::TouchPoint now = start;
  for (double s = 0; s < 1; now = at(q, a, b, s)) {
    if (now.gap <= deep) return true;
    if (now.gap <= met && normal.isZero(0)) normal = now.n;
    s += std::max(now.gap, kWayStride * width) / way;
  }
  return end.gap <= met && normal.dot(end.n) < 0;
}

}  // namespace orthant
