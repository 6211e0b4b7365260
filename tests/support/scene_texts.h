// tests/support/scene_texts.h — scenes as text, for what reads them.
#pragma once

#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace orthant::scene_texts {

using Strings = std::vector<std::string>;

inline const std::filesystem::path kCore =
    std::filesystem::path(ORTHANT_TEST_DATA).parent_path().parent_path() / "core";

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  REQUIRE(in.good());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Message of the error that reading throws; empty when it does not.
inline std::string error_of(std::string_view text, const Strings& overrides = {}) {
  try {
    parse_scene(text, overrides, "s.toml");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Three bodies on lines 1 to 13; what is added starts on line 14.
inline const std::string kBodies = R"([[body]]
name = "rod"
mass = 1
inertia = 1
[[body]]
name = "cart"
mass = 2
inertia = 3
position = [3, 4]
angle = 0.5
[[body]]
name = "ball"
mass = 1.0
inertia = 1.0
)";

inline const std::string kCorner = kBodies + R"([[contact]]
name = "foot"
type = "corner-wall"
body = "rod"
wall = {normal = [0, 2]}
)";

}  // namespace orthant::scene_texts
