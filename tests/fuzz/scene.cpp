#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/scene/scene_toml.h>

#include "target.h"

// The text; behind a NUL, an override.
void orthant::fuzz::scene(std::string_view bytes) {
  const auto end = bytes.find('\0');
  std::vector<std::string> overrides;
  if (end != std::string_view::npos) overrides.emplace_back(bytes.substr(end + 1));
  parse([&] { const System system(parse_scene(bytes.substr(0, end), overrides)); });
}
