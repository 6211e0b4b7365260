// orthant completion — bash completion of subcommands, options, and names of solvers, integrators and scenes.
//   source <(orthant completion)
#include "commands.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <iostream>
#include <sstream>

namespace orthant {
namespace {

template <class Entries> std::string names(const Entries& entries) {
  std::string list;
  for (const auto& entry : entries) list += (list.empty() ? "" : " ") + std::string(entry.name);
  return list;
}

std::string long_options(const CLI::App& command) {
  std::string list;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) list += (list.empty() ? "--" : " --") + name;
  return list;
}

std::string script(const CLI::App& app) {
  std::ostringstream out;
  std::string commands;
  for (const CLI::App* command : app.get_subcommands(nullptr)) commands += command->get_name() + " ";
  out << "_orthant() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words= first=1\n"
         "  [[ ${COMP_WORDS[1]} == --max-input ]] && first=3  # the command is behind it\n"
         "  (( COMP_CWORD == first )) && before=orthant  # whatever path it was called by\n"
         "  case $before in\n"
         "    --solver) words='"
      << names(solvers()) << "' ;;\n    --integrator) words='" << names(integrators()) << "' ;;\n    simulate) words='"
      << names(scenes()) << " " << names(spatial_scenes())
      << "' ;;\n    list) words='solvers integrators scenes' ;;\n    orthant) words='" << commands << long_options(app)
      << "' ;;\n  esac\n"
         "  if [[ -z $words && $word == -* ]]; then\n"
         "    case ${COMP_WORDS[first]} in\n";
  for (const CLI::App* command : app.get_subcommands(nullptr))
    out << "      " << command->get_name() << ") words='" << long_options(*command) << "' ;;\n";
  out << "    esac\n"
         "  fi\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"  // zsh and old bash have no mapfile
         "}\n"
         "complete -o default -F _orthant orthant\n";
  return out.str();
}

}  // namespace

void add_completion(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("completion", "A script for bash: source <(orthant completion)");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "as one JSON object");
  command->footer(
      "Exit codes: 0 done.\n"
      "Example:\n"
      "  source <(orthant completion)");
  command->callback([&app, &exit_code, json] {
    std::cout << (*json ? nlohmann::json{{"bash", script(app)}}.dump() + '\n' : script(app));
    exit_code = 0;
  });
}

}  // namespace orthant
