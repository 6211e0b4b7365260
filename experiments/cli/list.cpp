// orthant list — names for the command line: solvers, integrators and scenes with their options; fields of the summary.
//   --json the same for programs; --markdown prints the tables of experiments/README.md (solvers), of
//   experiments/docs/choose_integrator.md (integrators) and of experiments/docs/statuses.md (summary), which tests
//   compare.
#include "experiments/cli/commands.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/run_fields.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <iostream>

namespace orthant {
namespace {

template <class Entries> void print(const char* title, const Entries& entries) {
  std::cout << title << '\n';
  for (const auto& entry : entries) {
    std::cout << "  " << entry.name << "\n      " << entry.summary << '\n';
    if (const std::string options = text_of(entry.options()); !options.empty())
      std::cout << "      options: " << options << '\n';
    if constexpr (requires { entry.can; }) {
      std::string names;
      entry.can.visit([&](const char* name, bool can, const char*) {
        if (can) names += (names.empty() ? "" : ", ") + std::string(name);
      });
      std::cout << "      takes: " << names << '\n';
    }
  }
}

nlohmann::ordered_json value_of(const std::string& text) {  // a number or a word
  const auto value = nlohmann::ordered_json::parse(text, nullptr, false);
  return value.is_discarded() ? nlohmann::ordered_json(text) : value;
}

nlohmann::ordered_json options_as_json(const std::vector<OptionEntry>& options) {
  auto list = nlohmann::ordered_json::array();
  for (const OptionEntry& option : options) {
    nlohmann::ordered_json entry = {{"name", option.name}, {"default", value_of(option.value)}};
    if (!option.low.empty()) entry["range"] = {value_of(option.low), value_of(option.high)};
    if (!option.choices.empty()) entry["choices"] = option.choices;
    list.push_back(entry);
  }
  return list;
}

template <class Entries> nlohmann::ordered_json as_json(const Entries& entries) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& entry : entries) {
    list.push_back({{"name", entry.name}, {"summary", entry.summary}, {"options", options_as_json(entry.options())}});
    if constexpr (requires { entry.can; })
      entry.can.visit([&](const char* name, bool can, const char*) { list.back()["can"][name] = can; });
  }
  return list;
}

template <class Visit> void visit_summary(Visit&& visit) {
  Run run;
  visit_fields(run,
               [&](const char* field, const char* unit, const char* meaning, auto&) { visit(field, unit, meaning); });
}

void print_summary() {
  std::cout << "summary\n";
  visit_summary([](const std::string& field, const std::string& unit, const char* meaning) {
    std::cout << "  " << field << (unit.empty() ? "" : " [" + unit + "]") << "\n      " << meaning << '\n';
  });
}

nlohmann::ordered_json summary_as_json() {
  auto list = nlohmann::ordered_json::array();
  visit_summary([&](const char* field, const char* unit, const char* meaning) {
    list.push_back({{"name", field}, {"unit", unit}, {"meaning", meaning}});
  });
  return list;
}

void print_solver_table() {
  std::cout << "| solver | what it is |\n|---|---|\n";
  for (const SolverEntry& entry : solvers()) std::cout << "| `" << entry.name << "` | " << entry.summary << " |\n";
}

void print_integrator_table() {
  std::string head = "| integrator |", line = "|---|";
  Capabilities{}.visit(
      [&](const char*, bool, const char* words) { head += ' ' + std::string(words) + " |", line += "---|"; });
  std::cout << head << '\n' << line << '\n';
  for (const IntegratorEntry& entry : integrators()) {
    std::cout << "| `" << entry.name << "` |";
    entry.can.visit([](const char*, bool can, const char*) { std::cout << (can ? " yes |" : " no |"); });
    std::cout << '\n';
  }
}

void print_summary_table() {
  std::cout << "| field | unit | meaning |\n|---|---|---|\n";
  visit_summary([](const char* field, const char* unit, std::string meaning) {
    for (auto bar = meaning.find('|'); bar != std::string::npos; bar = meaning.find('|', bar + 2))
      meaning.insert(bar, "\\");
    std::cout << "| `" << field << "` | " << unit << " | " << meaning << " |\n";
  });
}

}  // namespace

void add_list(CLI::App& app, int& exit_code) {
  auto what = std::make_shared<std::string>();
  auto markdown = std::make_shared<bool>(false), json = std::make_shared<bool>(false);
  CLI::App* command =
      app.add_subcommand("list", "Solvers, integrators and scenes with their options; fields of a run's summary");
  command->add_option("what", *what, "solvers, integrators, scenes or summary; default: all")
      ->check(CLI::IsMember({"solvers", "integrators", "scenes", "summary"}));
  command->add_flag("--markdown", *markdown,
                    "the solvers, the integrators' capabilities, or the fields of the summary, as a Markdown table");
  command->add_flag("--json", *json, "all of it as one JSON object")->excludes("--markdown");
  command->footer(
      "Exit codes: 0 done, 1 bad input.\n"
      "Examples:\n"
      "  orthant list\n"
      "  orthant list solvers --json");
  command->callback([what, markdown, json, &exit_code] {
    exit_code = 0;
    if (*markdown)
      return *what == "summary"       ? print_summary_table()
             : *what == "integrators" ? print_integrator_table()
                                      : print_solver_table();
    const auto wanted = [&](const char* kind) { return what->empty() || *what == kind; };
    if (*json) {
      nlohmann::ordered_json all;
      if (wanted("solvers")) all["solvers"] = as_json(solvers());
      if (wanted("integrators")) all["integrators"] = as_json(integrators());
      if (wanted("scenes")) all["scenes"] = as_json(scenes()), all["spatial_scenes"] = as_json(spatial_scenes());
      if (wanted("summary")) all["summary"] = summary_as_json();
      std::cout << all.dump(2) << '\n';
      return;
    }
    if (wanted("solvers")) print("solvers", solvers());
    if (wanted("integrators")) print("integrators", integrators());
    if (wanted("scenes")) print("scenes", scenes()), print("scenes in space", spatial_scenes());
    if (wanted("summary")) print_summary();
  });
}

}  // namespace orthant
