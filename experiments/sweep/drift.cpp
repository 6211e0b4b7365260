#include "experiments/sweep/drift.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

template <class Element> bool between_bodies(const Element& x) {
  if constexpr (requires { x.a, x.b; })
    return x.a != kGround && x.b != kGround;
  else
    return false;  // a law of a relative coordinate
}

/// No shape of a searched collision is the ground's.
bool free_of_ground(const Scene& scene) {
  return std::ranges::all_of(scene.collisions, [](const Collision& c) {
    return std::ranges::none_of(c.shapes, [](const Shape& shape) { return shape.body == kGround; });
  });
}
bool free_of_ground(const spatial::Scene&) { return true; }

template <class Scene> bool isolated(const Scene& scene) {
  const auto inside = [](const auto& list) {
    return std::ranges::all_of(
        list, [](const auto& element) { return std::visit([](const auto& x) { return between_bodies(x); }, element); });
  };
  return scene.gravity.isZero(0) && scene.loads.empty() && scene.frictions.empty() && inside(scene.joints) &&
         inside(scene.contacts) && inside(scene.springs) && free_of_ground(scene);
}

Momenta momenta(const System& system, const State& x) {
  Momenta sum;
  for (Eigen::Index i = 0; i < x.q.size(); i += 3) {
    const double px = system.mass()[i] * x.v[i], py = system.mass()[i + 1] * x.v[i + 1];
    sum.linear += Eigen::Vector3d(px, py, 0);
    sum.angular.z() += x.q[i] * py - x.q[i + 1] * px + system.mass()[i + 2] * x.v[i + 2];
  }
  return sum;
}

Momenta momenta(const SystemOf<Spatial>& system, const State& x) {
  Momenta sum;
  for (Eigen::Index i = 0; i < system.bodies(); ++i) {
    const Eigen::Vector3d p = system.mass().segment<3>(6 * i).cwiseProduct(translation<Spatial>(x.v, i));
    const Eigen::Vector3d spin = system.mass().segment<3>(6 * i + 3).cwiseProduct(rotation<Spatial>(x.v, i));
    sum.linear += p;
    sum.angular +=
        Eigen::Vector3d(place_of<Spatial>(x.q, i)).cross(p) + quaternions::matrix_of(quaternion(x.q, i)) * spin;
  }
  return sum;
}

}  // namespace

template <class Space> Drift<Space>::Drift(const SystemOf<Space>& system) : system_(system) {
  momentum_ = spin_ = isolated(system.scene()) ? 0 : std::numeric_limits<double>::quiet_NaN();
}

template <class Space> void Drift<Space>::add(const State& x) {
  const double energy = orthant::energy(system_, x);
  const bool first = !started_;
  if (first) energy_0_ = energy, started_ = true;
  energy_ = std::max(energy_, std::abs(energy - energy_0_));
  if (std::isnan(momentum_)) return;
  const Momenta now = momenta(system_, x);
  if (first) start_ = now;
  momentum_ = std::max(momentum_, (now.linear - start_.linear).norm());
  spin_ = std::max(spin_, (now.angular - start_.angular).norm());
}

template class Drift<Planar>;
template class Drift<Spatial>;

}  // namespace orthant
