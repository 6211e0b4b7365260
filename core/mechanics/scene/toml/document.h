// core/mechanics/scene/toml/document.h — TOML document with overrides applied, and the line of each node.
//
// Not installed: TOML stays inside core.
#pragma once

#include <orthant/core/support/shortened.h>
#include <toml++/toml.h>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace orthant::scene_file {

inline std::string in_quotes(std::string_view s) { return '"' + in_one_line(s) + '"'; }

std::string join(const std::vector<std::string>& words);

/// Where a node was written: "door.toml:12", or the override that brought it.
std::string place(const toml::node& node, const std::string& file);

/// The node as one short line of TOML, numbers with as few digits as possible.
std::string text(const toml::node& node);

/// Throws std::invalid_argument with `name`, line and reason; so it does for text that is nested deeper than a scene.
toml::table parse(std::string_view text, const std::string& name);

/// An element's own name, or the one it gets from its place.
std::string name_of(const toml::node& element, std::string_view kind, std::size_t index);

/// "contact.corner1.mu=0.1": the text behind kind and name is one line of TOML as it would stand in that element. No
/// key twice, nor one within another.
void apply_overrides(toml::table& root, std::span<const std::string> overrides);

}  // namespace orthant::scene_file
