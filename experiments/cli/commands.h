// experiments/cli/commands.h — the subcommands of orthant. Each adds itself; exceptions from a run are bad input.
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace orthant {

void add_solve(CLI::App& app, int& exit_code);
void add_analyse(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_list(CLI::App& app, int& exit_code);

}  // namespace orthant
