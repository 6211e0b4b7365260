// tests/support/cli.h — the orthant command, run in a folder of the test's own.
#pragma once

#include "tests/support/folder.h"

namespace orthant {

struct Cli : Folder {
  Reply orthant(const std::string& arguments) const { return run("'" ORTHANT_CLI "' " + arguments); }
};

}  // namespace orthant
