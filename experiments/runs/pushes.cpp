#include "experiments/runs/pushes.h"

#include <type_traits>

namespace orthant {
namespace {

/// A point of the contact, in the world: on the surface of a disc, or the corner of a polygon.
template <class C> Vector2d touching_point(const C& c, const Kinematics& k, const Vector2d& n) {
  if constexpr (requires { c.centre_a; }) {
    const Pose& a = k.at(c.a);
    return a.x + a.turn(c.centre_a) - c.radius_a * n;
  } else if constexpr (requires { c.radius; }) {
    const Pose& a = k.at(c.a);
    return a.x + a.turn(c.centre) - c.radius * n;
  } else {
    const Pose& a = k.at(c.a);
    return a.x + a.turn(c.point);
  }
}

}  // namespace

void PushLog::add(const RunSample& moment) {
  constexpr std::size_t kMost = 500'000;  // 48 MB
  if (pushes_.size() > kMost) full_ = true, pushes_.clear(), pushes_.shrink_to_fit();
  if (full_) return;
  bool posed = false;
  for (std::size_t i = 0; i < moment.pairs.size(); ++i) {
    const Pair& pair = moment.pairs[i];
    const double impulse = moment.impulses[static_cast<std::size_t>(system_.listed()) + i].normal;
    if (pair.none() || !(impulse > 0)) continue;
    if (!posed) set_poses(system_, moment.state.t, moment.state.q, terms_.at);
    posed = true;
    const Collision& collision = system_.scene().collisions[static_cast<std::size_t>(pair.collision)];
    as_contact(collision, pair, terms_.at, [&](const auto& c) {
      const Row row = c.rows(terms_.at).normal;
      const bool ground = row.a == kGround;  // the normal points from b to a
      const Vector2d n = ground ? Vector2d(-row.jb[0], -row.jb[1]) : Vector2d(row.ja[0], row.ja[1]);
      pushes_.push_back({moment.state.t, pair, touching_point(c, terms_.at, n), n, impulse});
    });
  }
}

}  // namespace orthant
