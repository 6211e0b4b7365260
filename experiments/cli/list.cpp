// orthant list — what can be named on the command line: solvers, integrators, scenes, each with its options.
//   --json the same for programs; --markdown prints the solvers as the table of experiments/README.md, which a test compares.
#include "commands.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <iostream>
#include <regex>
#include <sstream>

namespace orthant {
namespace {

template <class Entries> void print(const char* title, const Entries& entries) {
  std::cout << title << '\n';
  for (const auto& entry : entries) {
    std::cout << "  " << entry.name << "\n      " << entry.summary << '\n';
    if (const std::string options = entry.options(); !options.empty())
      std::cout << "      options: " << options << '\n';
  }
}

nlohmann::ordered_json value_of(const std::string& text) {  // a number or a word
  const auto value = nlohmann::ordered_json::parse(text, nullptr, false);
  return value.is_discarded() ? nlohmann::ordered_json(text) : value;
}

/// What describe() writes of them, "omega=1 in [0, 2], form=auto of {auto|dense}, rescue=true", taken apart.
nlohmann::ordered_json options_as_json(std::string text) {
  auto list = nlohmann::ordered_json::array();
  static const std::regex option(R"((\w+)=([^, ]+)(?: in \[([^,]+), ([^\]]+)\]| of \{([^}]*)\})?)");
  for (std::sregex_iterator o(text.begin(), text.end(), option); o != std::sregex_iterator(); ++o) {
    const std::smatch& part = *o;
    nlohmann::ordered_json entry = {{"name", part.str(1)}, {"default", value_of(part.str(2))}};
    if (part[3].matched) entry["range"] = {value_of(part.str(3)), value_of(part.str(4))};
    if (part[5].matched) {
      std::istringstream choices(part.str(5));
      for (std::string choice; std::getline(choices, choice, '|');) entry["choices"].push_back(choice);
    }
    list.push_back(entry);
  }
  return list;
}

template <class Entries> nlohmann::ordered_json as_json(const Entries& entries) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& entry : entries)
    list.push_back({{"name", entry.name}, {"summary", entry.summary}, {"options", options_as_json(entry.options())}});
  return list;
}

void print_table() {
  std::cout << "| solver | what it is |\n|---|---|\n";
  for (const SolverEntry& entry : solvers()) std::cout << "| `" << entry.name << "` | " << entry.summary << " |\n";
}

}  // namespace

void add_list(CLI::App& app, int& exit_code) {
  auto what = std::make_shared<std::string>();
  auto markdown = std::make_shared<bool>(false), json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("list", "Solvers, integrators and scenes, with their options");
  command->add_option("what", *what, "solvers, integrators or scenes; default: all")
      ->check(CLI::IsMember({"solvers", "integrators", "scenes"}));
  command->add_flag("--markdown", *markdown, "the solvers as a Markdown table");
  command->add_flag("--json", *json, "all of it as one JSON object")->excludes("--markdown");
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Examples:\n"
      "  orthant list\n"
      "  orthant list solvers --json");
  command->callback([what, markdown, json, &exit_code] {
    exit_code = 0;
    if (*markdown) return print_table();
    const auto asked = [&](const char* kind) { return what->empty() || *what == kind; };
    if (*json) {
      nlohmann::ordered_json all;
      if (asked("solvers")) all["solvers"] = as_json(solvers());
      if (asked("integrators")) all["integrators"] = as_json(integrators());
      if (asked("scenes")) all["scenes"] = as_json(scenes());
      std::cout << all.dump(2) << '\n';
      return;
    }
    if (asked("solvers")) print("solvers", solvers());
    if (asked("integrators")) print("integrators", integrators());
    if (asked("scenes")) print("scenes", scenes());
  });
}

}  // namespace orthant
