// experiments/cli/command.h — the whole `orthant` command as a function: for the program and for the Python package.
#pragma once

#include "experiments/support/plugin.h"

#include <exception>
#include <string>

namespace orthant {

/// A kind of file that --plugin takes.
struct PluginKind {
  const char* what;  // in the help
  void (*load)(const std::filesystem::path& file);
  std::string (*words)(const std::exception& error);  // of an error that the plugin's code throws, or any other
};
inline constexpr PluginKind kCompiledPlugin{
    "shared library that registers solvers, integrators and scenes of its own; may be repeated", &load_plugin,
    [](const std::exception& error) { return std::string(error.what()); }};

/// argv as of a program, its name first. Writes to standard output and standard error; returns the exit code.
/// A compiled plugin uses code that the program exports. The Python package exports none and takes Python files.
int run_command(int argc, const char* const* argv, const PluginKind& plugins = kCompiledPlugin);

}  // namespace orthant
