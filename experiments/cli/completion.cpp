// orthant completion — completion of subcommands, options, and names of solvers, integrators and scenes; manual pages.
//   bash, zsh:  source <(orthant completion)           fish:  orthant completion fish | source
#include "experiments/cli/commands.h"
#include "experiments/cli/output_schemas.h"

#include "experiments/runs/manifest.h"
#include "experiments/support/manual.h"

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

/// Of the options that take a value, or of all.
std::string long_options(const CLI::App& command, bool all = true) {
  std::string list;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames())
      if (all || option->get_items_expected_max() > 0) list += (list.empty() ? "--" : " --") + name;
  return list;
}

/// Words other than files that complete the first positional argument of a command.
std::string arguments_of(const CLI::App& app, const std::string& command) {
  if (command == "simulate" || command == "view" || command == "check")
    return names(scenes()) + " " + names(spatial_scenes());
  if (command == "list") return "solvers integrators scenes summary";
  if (command == "completion") return "bash zsh fish";
  if (command == "new") return "mechanism";
  std::string list;
  if (command == "schema") {
    list = "scene";
    for (const std::string& name : output_schema_names()) list += " " + name;
  }
  if (command == "man")
    for (const CLI::App* one : app.get_subcommands(nullptr)) list += (list.empty() ? "" : " ") + one->get_name();
  return list;
}

/// Words before the cursor: the command is the first that is no option nor an option's value; bash makes three words of
/// --solver=lemke.
std::string script(const CLI::App& app) {
  std::ostringstream out;
  std::string commands;
  for (const CLI::App* command : app.get_subcommands(nullptr)) commands += command->get_name() + " ";
  out << "_orthant_of() {  # options, those with a value, arguments of a command\n  case $1 in\n";
  for (const CLI::App* command : app.get_subcommands(nullptr))
    out << "    " << command->get_name() << ") options='" << long_options(*command) << "' valued=' "
        << long_options(*command, false) << " ' arguments='" << arguments_of(app, command->get_name()) << "' ;;\n";
  out << "    *) options='" << long_options(app) << "' valued=' " << long_options(app, false) << " ' arguments='"
      << commands
      << "' ;;\n  esac\n}\n"
         "_orthant() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before= command= given=0 i=1 this words= options valued arguments\n"
         "  _orthant_of ''\n"
         "  while (( i < COMP_CWORD )); do\n"
         "    this=${COMP_WORDS[i]} before=\n"
         "    if [[ $this == --*=* || $this == = ]]; then :\n"
         "    elif [[ $valued == *\" $this \"* ]]; then\n"
         "      before=$this\n"
         "      [[ ${COMP_WORDS[i+1]} == = ]] && (( i + 1 < COMP_CWORD )) && i=$((i+1))\n"
         "      (( i + 1 < COMP_CWORD )) && i=$((i+1)) before=\n"
         "    elif [[ $this == -* ]]; then :\n"
         "    elif [[ -z $command ]]; then command=$this; _orthant_of \"$command\"\n"
         "    else given=1\n"
         "    fi\n"
         "    i=$((i+1))\n"
         "  done\n"
         "  [[ $word == = ]] && before=$this word=\n"
         "  case $before in\n"
         "    --solver) words='"
      << names(solvers()) << "' ;;\n    --integrator) words='" << names(integrators()) << "' ;;\n    --scene) words='"
      << arguments_of(app, "view")
      << "' ;;\n    '')\n"
         "      if [[ $word == -* ]]; then words=$options\n"
         "      elif (( given == 0 )); then words=$arguments\n"
         "      fi ;;\n"
         "  esac\n"
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

/// A function that reads the words before the cursor as the script for bash does; conditions ask it.
std::string fish_script(const CLI::App& app) {
  std::ostringstream out;
  out << "function __orthant_at  # COMMAND [NUMBER]: whether the cursor is there, behind so many arguments\n"
         "  set -l words (commandline -opc)\n"
         "  set -l command ''\n"
         "  set -l given 0\n"
         "  set -l valued "
      << long_options(app, false)
      << "\n"
         "  set -l value 0\n"
         "  for word in $words[2..-1]\n"
         "    if test $value = 1\n      set value 0\n"
         "    else if contains -- $word $valued\n      set value 1\n"
         "    else if string match -q -- '-*' $word\n"
         "    else if test -n \"$command\"\n      set given (math $given + 1)\n"
         "    else\n"
         "      set command $word\n"
         "      switch $command\n";
  for (const CLI::App* command : app.get_subcommands(nullptr))
    out << "        case " << command->get_name() << "\n          set valued " << long_options(*command, false) << '\n';
  out << "      end\n    end\n  end\n"
         "  test \"$command\" = \"$argv[1]\"; and begin; not set -q argv[2]; or test $given = $argv[2]; end\n"
         "end\n"
         "complete -c orthant -e\n";
  const auto options = [&](const CLI::App& command, const std::string& where) {
    for (const CLI::Option* option : command.get_options())
      for (const std::string& name : option->get_lnames()) {
        out << "complete -c orthant -n " << fish_quoted(where) << " -l " << name;
        if (option->get_items_expected_max() > 0) out << " -r";
        if (name == "solver") out << " -f -a " << fish_quoted(names(solvers()));
        if (name == "integrator") out << " -f -a " << fish_quoted(names(integrators()));
        if (name == "scene") out << " -a " << fish_quoted(arguments_of(app, "view"));
        out << " -d " << fish_quoted(option->get_description()) << '\n';
      }
  };
  const std::string before = "__orthant_at ''";
  options(app, before);
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    const std::string inside = "__orthant_at " + command->get_name();
    out << "complete -c orthant -f -n " << fish_quoted(before) << " -a " << command->get_name() << " -d "
        << fish_quoted(command->get_description()) << '\n';
    options(*command, inside);
    if (const std::string arguments = arguments_of(app, command->get_name()); !arguments.empty())
      out << "complete -c orthant -n " << fish_quoted(inside + " 0") << " -a " << fish_quoted(arguments) << '\n';
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
