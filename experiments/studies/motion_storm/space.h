// experiments/studies/motion_storm/space.h — names of planar and spatial scenes, for code that takes both.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant::motion_storm {

template <class Space> using SceneOf = typename ElementsOf<Space>::Scene;

template <class Scene> struct SpaceOfScene;
template <> struct SpaceOfScene<Scene> { using type = Planar; };
template <> struct SpaceOfScene<spatial::Scene> { using type = Spatial; };
template <class Scene> using SpaceOf = typename SpaceOfScene<Scene>::type;

template <class Space> Eigen::Index body_count(const SceneOf<Space>& scene) {
  return static_cast<Eigen::Index>(scene.bodies.size());
}

/// Whether a coordinate is an angle.
inline bool is_angle(const Coordinate& c) { return std::holds_alternative<Angle>(c); }
inline bool is_angle(const spatial::Coordinate& c) { return c.angle(); }

}  // namespace orthant::motion_storm
