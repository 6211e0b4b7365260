// experiments/cli/command.h — the whole `orthant` command as a function: for the program and for the Python package.
#pragma once

namespace orthant {

enum class Plugins { load, refuse };

/// argv as of a program, its name first. Writes to standard output and standard error; returns the exit code.
/// Plugins use the code of the program that loads them: where it exports none, they are refused and not offered.
int run_command(int argc, const char* const* argv, Plugins plugins = Plugins::load);

}  // namespace orthant
