// experiments/support/command_line.h — how a program of experiments/ takes its options: as asked, or one line of words.
#pragma once

#include "experiments/support/printable.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>
#include <optional>

namespace orthant {

/// Fills the options of `app`. Empty: go on; else the code to end with, 0 after --help, 1 after what is wrong was told.
inline std::optional<int> parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::cerr << std::filesystem::path(argv[0]).filename().string() << ": " << printable(error.what()) << '\n';
    return 1;
  }
}

}  // namespace orthant
