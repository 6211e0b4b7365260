// integrators/adaptive/crossing_state.h — states within a crossing of first order: interpolates between its ends.
//
//   v on the straight line; q too where contacts push, else on the parabola of this v. Kinetic energy is convex in v,
//   and that of weights and springs in q: on straight lines the energy is nowhere above the line between its ends.
#pragma once

#include <orthant/core/mechanics/blocks.h>
#include <orthant/integrators/integrator.h>

#include <algorithm>

namespace orthant {

/// x: from the crossing's start to time t [s]; x.t is not changed. impulses: [N s], one per contact.
template <class Space>
void move_within_crossing(double t, const State& end, const std::vector<ImpulseOf<Space>>& impulses, State& x) {
  const double rest = end.t - x.t, part = (t - x.t) / rest;
  move<Space>(x.q, part * between<Space>(x.q, end.q));
  if (std::ranges::none_of(impulses, [](const auto& push) { return push.normal != 0; }))
    move<Space>(x.q, -part * (1 - part) * rest / 2 * (end.v - x.v));
  x.v += part * (end.v - x.v);
}

}  // namespace orthant
