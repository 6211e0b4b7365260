// orthant import — a model in URDF or MJCF as a scene file, commented, with a list of what was not taken.
#include "experiments/cli/commands.h"

#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/support/file.h>

#include <nlohmann/json.hpp>

#include <iostream>

namespace orthant {
namespace {

struct ImportArguments {
  std::string model, output;
  std::vector<std::string> sets;
  bool json = false;
};

/// What is after "model." in each.
std::vector<std::string> options_of(const std::vector<std::string>& sets) {
  constexpr std::string_view kOption = "model.";
  std::vector<std::string> options;
  for (const std::string& set : sets) {
    if (!set.starts_with(kOption) || set.find('=') == std::string::npos)
      throw std::invalid_argument("--set '" + set + "': must have the form model.KEY=VALUE");
    options.push_back(set.substr(kOption.size()));
  }
  return options;
}

int run_import(const ImportArguments& arguments) {
  const std::string text = read_scene_text(arguments.model);
  if (!is_model(text))
    throw std::invalid_argument(arguments.model + ": must be a model in URDF or MJCF, which are XML");
  const ImportedModel model = import_model(text, arguments.model, options_of(arguments.sets));
  static_cast<void>(parse_any_scene(model.toml, {}, arguments.model + " (imported)"));  // a scene that runs, or words
  const bool to_file = !arguments.output.empty() && arguments.output != "-";
  if (!to_file) {
    if (!arguments.json) std::cout << model.toml;
  } else {
    check_apart("--output", arguments.output, "the model", arguments.model);
    write_whole(arguments.output, model.toml);
  }
  if (arguments.json) {
    nlohmann::ordered_json json;
    if (!to_file)
      json["toml"] = model.toml;
    else
      json["scene"] = arguments.output;
    json["notes"] = model.notes;
    std::cout << json.dump(2) << '\n';
    return 0;
  }
  for (const std::string& note : model.notes) std::cerr << "orthant: note: " << note << '\n';
  if (to_file) std::cout << "scene: " << arguments.output << '\n';
  return 0;
}

}  // namespace

void add_import(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command = app.add_subcommand("import", "A model in URDF or MJCF as a scene file");
  command->add_option("model", arguments->model, "robot in URDF, or model in MJCF (MuJoCo's XML)")->required();
  command->add_option("--output", arguments->output, "the scene, TOML; default, or -: standard output");
  command
      ->add_option("--set", arguments->sets,
                   "model.KEY=VALUE, may be repeated: base (fixed or free), at.JOINT (value at the start, rad or m), "
                   "floor (height of a half-space, m), mu, fixed_joints (merge or keep), folder (from which meshes may "
                   "be read)")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_flag("--json", arguments->json, "the scene or where it is, and notes, as one JSON object");
  command->footer(
      "Notes name everything in the model that the scene has not. `orthant simulate` and `orthant view` take models\n"
      "as they are, with the same --set.\n"
      "Exit codes: 0 done, 1 bad input.\n"
      "Examples:\n"
      "  orthant import robot.urdf --output robot.toml\n"
      "  orthant import robot.urdf --set model.at.shoulder=0.5 --set model.floor=0\n"
      "  orthant import model.xml --json");
  command->callback([arguments, &exit_code] { exit_code = run_import(*arguments); });
}

}  // namespace orthant
