#include <orthant/core/mechanics/dynamics/joint_load.h>

namespace orthant {
namespace {

constexpr double kSame = 1e-9;  // [m], or of a unit vector

bool same(const Vector2d& x, const Vector2d& y) { return (x - y).norm() <= kSame * (1 + x.norm()); }

bool copies(const Revolute& x, const Revolute& y) {
  return (x.a == y.a && x.b == y.b && same(x.point_a, y.point_a) && same(x.point_b, y.point_b)) ||
         (x.a == y.b && x.b == y.a && same(x.point_a, y.point_b) && same(x.point_b, y.point_a));
}
bool copies(const Prismatic& x, const Prismatic& y) {
  const Pose turned{{0, 0}, x.angle, std::cos(x.angle), std::sin(x.angle)};
  const auto parallel = [&](const Vector2d& axis) { return std::abs(cross(axis, y.axis)) <= kSame; };
  return (x.a == y.a && x.b == y.b && parallel(x.axis)) ||
         (x.a == y.b && x.b == y.a && parallel(turned.turn_back(x.axis)));
}
template <class X, class Y> bool copies(const X& /*x*/, const Y& /*y*/) { return false; }

}  // namespace

std::vector<int> copies_of(const Scene& scene, int joint) {
  std::vector<int> found;
  const auto& joints = scene.joints;
  for (int i = 0; i < static_cast<int>(joints.size()); ++i)
    if (i == joint || std::visit([](const auto& x, const auto& y) { return copies(x, y); },
                                 joints[static_cast<std::size_t>(joint)], joints[static_cast<std::size_t>(i)]))
      found.push_back(i);
  return found;
}

std::vector<int> copies_of(const spatial::Scene& /*scene*/, int joint) { return {joint}; }

template <class Space> JointLoadOf<Space>::JointLoadOf(const SystemOf<Space>& system, int joint) {
  const auto& joints = system.scene().joints;
  const auto [a, b] = std::visit([](const auto& j) { return bodies_of(j); }, joints[static_cast<std::size_t>(joint)]);
  body_ = a >= 0 ? a : b;
  for (const int i : copies_of(system.scene(), joint)) {
    const int first = system.first_row(static_cast<std::size_t>(i));
    const int rows = row_count(joints[static_cast<std::size_t>(i)]);
    for (int row = first; row < first + rows; ++row) rows_.push_back(row);
  }
}

template <class Space> double JointLoadOf<Space>::size(std::span<const RowOf<Space>> G, const double* lambda) const {
  typename Space::Vector sum = Space::Vector::Zero();
  for (const int i : rows_) sum += lambda[i] * push_on(G[static_cast<std::size_t>(i)], body_);
  return sum.norm();
}

template class JointLoadOf<Planar>;
template class JointLoadOf<Spatial>;

}  // namespace orthant
