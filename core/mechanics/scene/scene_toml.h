// core/mechanics/scene/scene_toml.h — scenes from TOML text. Format, every element and key: core/scenes/README.md.
//
//   Scene s = read_scene("door.toml", std::vector<std::string>{"gravity=[0, 0]", "contact.corner1.mu=0.1"});
//
// An override is one line of TOML. Its key path addresses an element by kind and name, then a key of the format, which
// the file itself need not have: contact.corner1.wall.normal=[0, 1]. An inline table replaces, a key path adds.
// Everything wrong (text that is no TOML, unknown or missing keys, wrong types, values that check() refuses) throws
// std::invalid_argument with file and line or override, element, key, value and rule. Hostile text is refused as well:
// files over 16 MiB (support/file.h: largest_input()), keys and brackets nested deeper than any scene needs.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace orthant {

Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides = {});

/// The text of the file that read_scene() reads, to be stored with the results.
std::string read_scene_text(const std::filesystem::path& file);

/// `name` stands for the file in error messages.
Scene parse_scene(std::string_view text, std::span<const std::string> overrides = {}, std::string_view name = "scene");

/// A scene in the plane, or in space where the file (or an override) has dimension = 3. Text in XML is a model in URDF
/// or MJCF, a scene in space (mechanics/models/import.h); overrides `model.KEY=VALUE` are options of its import then.
using AnyScene = std::variant<Scene, spatial::Scene>;
AnyScene read_any_scene(const std::filesystem::path& file, std::span<const std::string> overrides = {});
AnyScene parse_any_scene(std::string_view text, std::span<const std::string> overrides = {},
                         std::string_view name = "scene");

}  // namespace orthant
