#include <orthant/core/mechanics/models/attributes.h>
#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/models/mjcf.h>
#include <orthant/core/mechanics/models/urdf.h>
#include <orthant/core/support/shortened.h>

namespace orthant {

bool is_model(std::string_view text) { return models::looks_like_xml(text); }

ImportedModel import_model(std::string_view text, const std::string& file, std::span<const std::string> sets) {
  return in_a_line([&] {
    models::ModelOptions options;
    for (const std::string& set : sets) options.set(set);
    models::XmlElement root = models::parse_xml(text, file);
    models::ModelFiles files(file, options.folder);
    root.read = true;
    if (root.name != "robot" && root.name != "mujoco")
      models::refuse(root, "must be <robot> (URDF) or <mujoco> (MJCF)");
    models::Model model =
        root.name == "robot" ? models::read_urdf(root, files, options) : models::read_mjcf(root, files);
    for (const std::string& what : models::unread(root)) model.notes.push_back("not taken: " + what);
    ImportedModel result;
    result.toml = models::scene_text(model, options);
    result.notes = std::move(model.notes);
    return result;
  });
}

}  // namespace orthant
