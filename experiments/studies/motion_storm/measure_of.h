// experiments/studies/motion_storm/measure_of.h — the measure of a scene in the plane or in space.
#pragma once

#include "experiments/studies/motion_storm/measure.h"
#include "experiments/studies/motion_storm/spatial_measure.h"

#include <orthant/core/mechanics/dynamics/state.h>

#include <cmath>
#include <type_traits>

namespace orthant::motion_storm {

template <class Space> using MeasureOf = std::conditional_t<kPlanar<Space>, Measure, SpatialMeasure>;

/// [rad/s] and [m/s] of a body.
template <class Space> double turning_of(const State& x, Eigen::Index b) {
  if constexpr (kPlanar<Space>)
    return std::abs(rotation(x.v, b));
  else
    return rotation<Space>(x.v, b).norm();
}
template <class Space> double speed_of(const State& x, Eigen::Index b) { return translation<Space>(x.v, b).norm(); }

}  // namespace orthant::motion_storm
