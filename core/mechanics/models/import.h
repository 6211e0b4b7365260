// core/mechanics/models/import.h — import of robots and mechanisms in URDF and MJCF (MuJoCo's XML) as scenes in space.
//
//   const ImportedModel arm = import_model(read_scene_text("arm.urdf"), "arm.urdf");
//   write_whole("arm.toml", arm.toml);                    // a scene as core/scenes/space.md describes it, commented
//   AnyScene scene = read_any_scene("arm.urdf");          // the same in one step
// The root element determines the format: <robot> or <mujoco>. Supported elements: urdf.h, mjcf.h. `notes` lists all
// other elements. Its entries begin with "not taken: ", or describe a change.
// Safe for untrusted files: sizes are bounded, document types refused, no file outside the model's folder is read.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace orthant {

struct ImportedModel {
  std::string toml;
  std::vector<std::string> notes;
};

/// `sets`: options KEY=VALUE, without "model." in front: base (fixed or free), fixed_joints (merge or keep), folder,
/// floor [m], mu, at.JOINT [rad or m]. `file` is where the text comes from; other files are looked up from there.
/// Throws std::invalid_argument naming file, line, element, value and rule.
ImportedModel import_model(std::string_view text, const std::string& file, std::span<const std::string> sets = {});

/// Whether the text is XML, so a model and no scene.
bool is_model(std::string_view text);

}  // namespace orthant
