// experiments/studies/motion_storm/scenes.h — random mechanisms, planar and spatial, by kind, seed and number.
#pragma once

#include "experiments/studies/motion_storm/space.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace orthant::motion_storm {

/// Names of the kinds; the kind of scene k is k modulo their number. Planar scenes of every twelfth round are of other
/// kinds, in turn: gears, terrain.
template <class Space = Planar> std::span<const std::string_view> kinds();
constexpr bool of_further_kinds(std::uint64_t round) { return round % 12 == 6; }

/// Scene k of a seed: always the same. It is checked; its step and duration are set.
template <class Space> struct RandomSceneOf {
  std::string kind;
  SceneOf<Space> scene;
};
using RandomScene = RandomSceneOf<Planar>;
template <class Space = Planar> RandomSceneOf<Space> random_scene(std::uint64_t seed, std::uint64_t k);

/// The scene as a TOML file that gives the same scene again; loads without a factor only.
std::string to_toml(const Scene& scene, const std::string& comment);
std::string to_toml(const spatial::Scene& scene, const std::string& comment);
/// Whether a contact is written by one before it, as rims of a cylinder and of a pin are.
bool follows_in_set(const spatial::Contact& contact);

}  // namespace orthant::motion_storm
