#include "drift.h"

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

bool isolated(const Scene& scene) {
  const auto inside = [](const auto& list) {
    return std::ranges::all_of(
        list, [](const auto& element) { return std::visit([](const auto& x) { return between_bodies(x); }, element); });
  };
  const bool free_shapes = std::ranges::all_of(scene.collisions, [](const Collision& c) {
    return std::ranges::none_of(c.shapes, [](const Shape& shape) { return shape.body == kGround; });
  });
  return scene.gravity.isZero(0) && scene.loads.empty() && scene.frictions.empty() && inside(scene.joints) &&
         inside(scene.contacts) && inside(scene.springs) && free_shapes;
}

Eigen::Vector3d momenta(const System& system, const State& x) {
  Eigen::Vector3d sum{0, 0, 0};
  for (Eigen::Index i = 0; i < x.q.size(); i += 3) {
    const double px = system.mass()[i] * x.v[i], py = system.mass()[i + 1] * x.v[i + 1];
    sum += Eigen::Vector3d(px, py, x.q[i] * py - x.q[i + 1] * px + system.mass()[i + 2] * x.v[i + 2]);
  }
  return sum;
}

}  // namespace

Drift::Drift(const System& system) : system_(system) {
  momentum_ = spin_ = isolated(system.scene()) ? 0 : std::numeric_limits<double>::quiet_NaN();
}

void Drift::add(const State& x) {
  const double energy = orthant::energy(system_, x);
  const bool first = !started_;
  if (first) energy_0_ = energy, started_ = true;
  energy_ = std::max(energy_, std::abs(energy - energy_0_));
  if (std::isnan(momentum_)) return;
  const Eigen::Vector3d now = momenta(system_, x);
  if (first) start_ = now;
  momentum_ = std::max(momentum_, (now - start_).head<2>().norm());
  spin_ = std::max(spin_, std::abs(now[2] - start_[2]));
}

}  // namespace orthant
