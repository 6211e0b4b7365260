// experiments/support/manual.h — manual pages (troff) of the command, from the same options that --help prints.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace orthant {

/// Section 1, of the command itself, or of a subcommand: NAME-SUBCOMMAND. `date` as 2026-01-31.
std::string manual_page(const CLI::App& command, const std::string& version, const std::string& date);

}  // namespace orthant
