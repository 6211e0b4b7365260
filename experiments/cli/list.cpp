// orthant list — what can be named on the command line: solvers, integrators, scenes, each with its options.
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

}  // namespace

void add_list(CLI::App& app, int& exit_code) {
  auto what = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("list", "Solvers, integrators and scenes, with their options");
  command->add_option("what", *what, "solvers, integrators or scenes; default: all")
      ->check(CLI::IsMember({"solvers", "integrators", "scenes"}));
  command->callback([what, &exit_code] {
    if (what->empty() || *what == "solvers") print("solvers", solvers());
    if (what->empty() || *what == "integrators") print("integrators", integrators());
    if (what->empty() || *what == "scenes") print("scenes", scenes());
    exit_code = 0;
  });
}

}  // namespace orthant
