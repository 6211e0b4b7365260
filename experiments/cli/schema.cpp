// orthant schema — JSON Schema of scene files, and of the JSON that commands print.
#include "experiments/cli/commands.h"

#include "experiments/cli/output_schemas.h"

#include <orthant/core/mechanics/scene/scene_schema.h>

#include <iostream>

namespace orthant {

void add_schema(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("schema", "JSON Schema of scene files, and of what commands print as JSON");
  auto what = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  auto names = output_schema_names();
  names.insert(names.begin(), "scene");
  command
      ->add_option("what", *what,
                   "scene: TOML scene files; error: bad input; else a command: what it prints with --json")
      ->required()
      ->check(CLI::IsMember(names));
  command->add_flag("--json", *json, "a schema is JSON: no difference");
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Examples, the first for completion in an editor with taplo (#:schema ./scene.schema.json as the scene's first\n"
      "line):\n"
      "  orthant schema scene > scene.schema.json\n"
      "  orthant schema solve");
  command->callback([what, &exit_code] {
    std::cout << (*what == "scene" ? scene_schema() : output_schema(*what).dump(2) + "\n");
    exit_code = 0;
  });
}

}  // namespace orthant
