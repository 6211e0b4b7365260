// orthant check — a scene explained before it is run.
#include "experiments/cli/commands.h"

#include "experiments/runs/scene_account.h"

#include <orthant/core/scenes/registry.h>

#include <nlohmann/json.hpp>

#include <iostream>

namespace orthant {

void add_check(CLI::App& app, int& exit_code) {
  struct Arguments {
    std::string scene;
    std::vector<std::string> sets;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("check", "Explain a scene: mobility, redundant joints, jams, clearances, advice");
  command->add_option("scene", arguments->scene, "built-in scene or TOML file")->required();
  add_overrides(*command, arguments->sets);
  command->add_flag("--json", arguments->json, "as one JSON object");
  command->footer(
      "Exit codes: 0 a run can begin, 1 bad input, 3 the drives jam.\n"
      "Examples:\n"
      "  orthant check mine.toml\n"
      "  orthant check slider_crank --set clearance=1e-4 --json");
  command->callback([arguments, &exit_code] {
    const SceneAccount account = std::visit([](const auto& system) { return account_of(system); },
                                            make_any_system(arguments->scene, arguments->sets));
    std::cout << (arguments->json ? as_json(account).dump(2) + "\n" : in_words(account));
    exit_code = account.jam.empty() ? 0 : 3;
  });
}

}  // namespace orthant
