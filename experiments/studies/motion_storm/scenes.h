// experiments/studies/motion_storm/scenes.h — random planar mechanisms: generator by kind, seed and number.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace orthant::motion_storm {

/// Names of the kinds; the kind of scene k is k modulo their number.
std::span<const std::string_view> kinds();

/// Scene k of a seed: always the same. It is checked; its step and duration are set.
struct RandomScene {
  std::string kind;
  Scene scene;
};
RandomScene random_scene(std::uint64_t seed, std::uint64_t k);

/// The scene as a TOML file that gives the same scene again; loads without a factor only.
std::string to_toml(const Scene& scene, const std::string& comment);

}  // namespace orthant::motion_storm
