// orthant completion — completion of subcommands, options, and names of solvers, integrators and scenes; manual pages.
//   bash, zsh:  source <(orthant completion)           fish:  orthant completion fish | source
#include "commands.h"

#include "../support/manifest.h"
#include "../support/manual.h"

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
      << names(scenes()) << " " << names(spatial_scenes()) << "' ;;\n    view|check) words='" << names(scenes())
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

std::string fish_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + "'";
}

std::string fish_script(const CLI::App& app) {
  std::ostringstream out;
  out << "complete -c orthant -e\n";
  const auto options = [&](const CLI::App& command, const std::string& where) {
    for (const CLI::Option* option : command.get_options())
      for (const std::string& name : option->get_lnames()) {
        out << "complete -c orthant -n " << fish_quoted(where) << " -l " << name;
        if (option->get_items_expected_max() > 0) out << " -r";
        if (name == "solver") out << " -f -a " << fish_quoted(names(solvers()));
        if (name == "integrator") out << " -f -a " << fish_quoted(names(integrators()));
        out << " -d " << fish_quoted(option->get_description()) << '\n';
      }
  };
  options(app, "__fish_use_subcommand");
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    const std::string inside = "__fish_seen_subcommand_from " + command->get_name();
    out << "complete -c orthant -f -n __fish_use_subcommand -a " << command->get_name() << " -d "
        << fish_quoted(command->get_description()) << '\n';
    options(*command, inside);
    for (const char* of_scenes : {"simulate", "view", "check"})
      if (command->get_name() == of_scenes)
        out << "complete -c orthant -n " << fish_quoted(inside) << " -a " << fish_quoted(names(scenes())) << '\n';
  }
  return out.str();
}

std::string script_for(const CLI::App& app, const std::string& shell) {
  if (shell == "fish") return fish_script(app);
  return (shell == "zsh" ? "autoload -U +X bashcompinit && bashcompinit\n" : "") + script(app);
}

}  // namespace

void add_completion(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("completion", "A script for bash, zsh or fish: source <(orthant completion)");
  auto json = std::make_shared<bool>(false);
  auto shell = std::make_shared<std::string>("bash");
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->capture_default_str();
  command->add_flag("--json", *json, "as one JSON object");
  command->footer(
      "Exit codes: 0 done.\n"
      "Examples:\n"
      "  source <(orthant completion)\n"
      "  orthant completion fish | source");
  command->callback([&app, &exit_code, json, shell] {
    const std::string text = script_for(app, *shell);
    std::cout << (*json ? nlohmann::json{{*shell, text}}.dump() + '\n' : text);
    exit_code = 0;
  });
}

void add_man(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("man", "The manual page of orthant or of a subcommand, for man and troff");
  auto json = std::make_shared<bool>(false);
  auto of = std::make_shared<std::string>();
  command->add_option("of", *of, "a subcommand; default: orthant itself");
  command->add_flag("--json", *json, "as one JSON object");
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Example:\n"
      "  orthant man simulate | man -l -");
  command->callback([&app, &exit_code, json, of] {
    const auto found = app.get_subcommands([&](const CLI::App* sub) { return sub->get_name() == *of; });
    if (found.empty() && !of->empty())
      throw std::invalid_argument("'" + *of + "' is no subcommand: must be one that orthant --help lists");
    const auto about = manifest();
    const std::string page = manual_page(found.empty() ? app : *found.front(), about["version"].get<std::string>(),
                                         about["written"].get<std::string>().substr(0, 10));
    std::cout << (*json ? nlohmann::json{{"page", page}}.dump() + '\n' : page);
    exit_code = 0;
  });
}

}  // namespace orthant
