// orthant list — what can be named on the command line: solvers, integrators, scenes, each with its options.
//   --markdown prints the solvers as the README's table, which a test compares.
#include "commands.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <iostream>

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

void print_table() {
  std::cout << "| solver | what it is |\n|---|---|\n";
  for (const SolverEntry& entry : solvers()) std::cout << "| `" << entry.name << "` | " << entry.summary << " |\n";
}

}  // namespace

void add_list(CLI::App& app, int& exit_code) {
  auto what = std::make_shared<std::string>();
  auto markdown = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("list", "Solvers, integrators and scenes, with their options");
  command->add_option("what", *what, "solvers, integrators or scenes; default: all")
      ->check(CLI::IsMember({"solvers", "integrators", "scenes"}));
  command->add_flag("--markdown", *markdown, "the solvers as a table for the README");
  command->callback([what, markdown, &exit_code] {
    exit_code = 0;
    if (*markdown) return print_table();
    if (what->empty() || *what == "solvers") print("solvers", solvers());
    if (what->empty() || *what == "integrators") print("integrators", integrators());
    if (what->empty() || *what == "scenes") print("scenes", scenes());
  });
}

}  // namespace orthant
