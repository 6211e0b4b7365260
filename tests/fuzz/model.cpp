#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/scene/scene_toml.h>

#include "target.h"

// URDF or MJCF, by the root. What is taken is a scene: its text is read without an error of TOML's.
bool orthant::fuzz::model(std::string_view bytes) {
  std::string toml;
  parse([&] { toml = import_model(bytes, "model.xml").toml; });
  if (toml.empty()) return false;
  return parse([&] {
    try {
      const SystemOf<Spatial> system(std::get<spatial::Scene>(parse_any_scene(toml, {}, "imported")));
    } catch (const std::invalid_argument& error) {
      const std::string words = error.what();
      for (const char* grammar : {"unknown key", "missing key", "Error while parsing", "must be three numbers"})
        if (words.find(grammar) != std::string::npos) broken("text that a scene may be", words);
      throw;
    }
  });
}
