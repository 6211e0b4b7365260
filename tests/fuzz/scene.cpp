#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/scene/scene_toml.h>

#include "target.h"

// The text, in the plane or in space; behind a NUL, an override.
bool orthant::fuzz::scene(std::string_view bytes) {
  const auto end = bytes.find('\0');
  std::vector<std::string> overrides;
  if (end != std::string_view::npos) overrides.emplace_back(bytes.substr(end + 1));
  return parse([&] {
    const AnyScene scene = parse_any_scene(bytes.substr(0, end), overrides);
    if (const auto* planar = std::get_if<Scene>(&scene))
      const System system(*planar);
    else
      const SystemOf<Spatial> system(std::get<spatial::Scene>(scene));
  });
}
