// experiments/support/command_line.h — command line of the programs of experiments/: parsed, or refused in one line.
#pragma once

#include "experiments/support/help_text.h"
#include "experiments/support/printable.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>
#include <optional>

namespace orthant {

/// Fills the options of `app`. Empty: go on; else the code to end with, 0 after --help, 1 after an error message.
inline std::optional<int> parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::CallForHelp&) {
    std::cout << wrapped(app.help(), terminal_width());
    return 0;
  } catch (const CLI::Success& other) {
    return app.exit(other);
  } catch (const CLI::ParseError& error) {
    std::cerr << std::filesystem::path(argv[0]).filename().string() << ": " << printable(error.what()) << '\n';
    return 1;
  }
}

}  // namespace orthant
