// experiments/cli/command.h — the whole `orthant` command as a function: for the program and for the Python package.
#pragma once

namespace orthant {

/// argv as of a program, its name first. Writes to standard output and standard error; returns the exit code.
int run_command(int argc, const char* const* argv);

}  // namespace orthant
