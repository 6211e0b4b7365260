// core/scenes/registry.h — scene registry: the built-in scenes by name, in one table; all others are TOML files.
//
//   Scene s = make_scene("slider_crank", std::vector<std::string>{"mu=0.1", "omega3=-0.01"});
//   Scene t = make_scene("door.toml", std::vector<std::string>{"contact.corner1.mu=0.1"});
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/support/option_list.h>

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

template <class Scene> struct SceneEntryOf {
  std::string_view name, summary;
  std::function<Scene(std::span<const std::string> sets)> make;
  std::function<std::vector<OptionEntry>()> options;  // with defaults and ranges
};
using SceneEntry = SceneEntryOf<Scene>;
using SpatialSceneEntry = SceneEntryOf<spatial::Scene>;

std::span<const SceneEntry> scenes();
std::span<const SpatialSceneEntry> spatial_scenes();

/// One more row, behind the others: the command, Python and sweeps know its name from then on. Name and summary are
/// copied. Not while another thread uses the registry. Throws std::invalid_argument for a name that is taken, or of
/// other than a–z, 0–9, - and _.
void register_scene(SceneEntry entry);
void register_scene(SpatialSceneEntry entry);

bool is_built_in(std::string_view name);

/// A built-in scene, whose `sets` are its options ("key=value"), or else a file, whose `sets` are the overrides of
/// scene_toml.h. Neither of them, and bad sets: std::invalid_argument that lists what there is.
Scene make_scene(std::string_view name_or_path, std::span<const std::string> sets = {});

/// Likewise of a scene in the plane or in space. make_scene() takes the former only.
AnyScene make_any_scene(std::string_view name_or_path, std::span<const std::string> sets = {});

/// The system of that scene. A scene that comes from a file is examined once, by its reader.
using AnySystem = std::variant<System, SystemOf<Spatial>>;
AnySystem make_any_system(std::string_view name_or_path, std::span<const std::string> sets = {});

}  // namespace orthant
