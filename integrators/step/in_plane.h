// integrators/step/in_plane.h — planar parts of a step: features that only planar scenes have.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/integrators/checkpoint.h>

#include <type_traits>

namespace orthant {

/// In space: no geometric stiffness.
template <class Space> struct NotInSpace {
  template <class... T> explicit NotInSpace(const SystemOf<Space>& /*system*/, const T&... /*more*/) {}
  static constexpr bool possible() { return false; }
  static constexpr bool any() { return false; }
  void remember(CheckpointData& /*memory*/) {}
};

template <class Space, class Part> using InPlane = std::conditional_t<kPlanar<Space>, Part, NotInSpace<Space>>;

}  // namespace orthant
