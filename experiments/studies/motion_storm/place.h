// experiments/studies/motion_storm/place.h — points, directions and relative coordinates of planar bodies in a recorded
// state.
#pragma once

#include <orthant/core/mechanics/planar/relation.h>
#include <orthant/core/mechanics/scene/scene.h>

#include <cmath>

namespace orthant::motion_storm {

/// A body's point or direction in the world.
struct Place {
  const Eigen::VectorXd& q;
  double angle(BodyId b) const { return b < 0 ? 0 : q[3 * b + 2]; }
  Vector2d turn(BodyId b, const Vector2d& p) const {
    const double c = std::cos(angle(b)), s = std::sin(angle(b));
    return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
  }
  Vector2d at(BodyId b, const Vector2d& p) const {
    return b < 0 ? p : Vector2d(q[3 * b] + turn(b, p).x(), q[3 * b + 1] + turn(b, p).y());
  }
  Polygon at(BodyId b, const Polygon& corners) const {
    Polygon all;
    for (const Vector2d& c : corners) all.push_back(at(b, c));
    return all;
  }
  double value(const Coordinate& of) const {
    if (const auto* a = std::get_if<Angle>(&of)) return angle(a->b) - angle(a->a);
    if (const auto* s = std::get_if<Slide>(&of))
      return turn(s->a, s->axis).dot(at(s->b, s->point_b) - at(s->a, s->point_a));
    const auto& d = std::get<Span>(of);
    return (at(d.a, d.point_a) - at(d.b, d.point_b)).norm();
  }
  double value(const CoordinateSum& sum) const {
    double total = 0;
    for (const CoordinateTerm& term : sum.terms()) total += term.factor * value(term.of);
    return total;
  }
};

}  // namespace orthant::motion_storm
