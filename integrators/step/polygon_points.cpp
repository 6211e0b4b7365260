#include <orthant/integrators/step/polygon_points.h>

namespace orthant {

std::optional<std::array<Touch, 2>> polygon_points(const System& system, const std::vector<Pair>& pairs, int contact,
                                                   const Kinematics& at) {
  const auto both = [&](const Placed& a, const Placed& b, int point) -> std::array<Touch, 2> {
    return {touch(at, a, b, point), touch(at, a, b, 1 - point)};
  };
  if (contact < system.listed()) {
    const auto* p = std::get_if<PolygonPolygon>(&system.scene().contacts[static_cast<std::size_t>(contact)]);
    if (p == nullptr) return {};
    return both({p->a, p->corners_a, p->exposed_a.get()}, {p->b, p->corners_b, p->exposed_b.get()}, p->point);
  }
  const Pair& pair = pairs[static_cast<std::size_t>(contact - system.listed())];
  const auto& shapes = system.scene().collisions[static_cast<std::size_t>(pair.collision)].shapes;
  const Shape &x = shapes[static_cast<std::size_t>(pair.a)], &y = shapes[static_cast<std::size_t>(pair.b)];
  if (x.corners.empty() || y.corners.empty()) return {};
  return both({x.body, x.corners, x.exposed.get()}, {y.body, y.corners, y.exposed.get()}, pair.point);
}

bool overlap_ends(const std::array<Touch, 2>& points, const Kinematics& at, const Eigen::VectorXd& v, double d,
                  double d_rate) {
  const auto *first = std::get_if<CornerWall>(&points[0]), *second = std::get_if<CornerWall>(&points[1]);
  if (first == nullptr || second == nullptr || first->a == second->a) return false;  // corners of one polygon: ṡ = 0
  const auto arm = [&](const CornerWall& c) { return at.at(c.a).turn(c.point); };
  const auto rate = [&](const CornerWall& c) -> Vector2d { return twist_of(v, c.a).at(arm(c)); };
  const Vector2d s = at.at(second->a).x + arm(*second) - at.at(first->a).x - arm(*first);
  const double shrinks = s.dot(rate(*second) - rate(*first)) / s.squaredNorm();  // ṡ/s
  return shrinks < 0 && 2 * shrinks < d_rate / d;
}

}  // namespace orthant
