// experiments/support/manifest.h — what a result depends on besides its own options: revision, build, machine, packages.
#pragma once

#include <nlohmann/json.hpp>

namespace orthant {

/// revision (with "+changes" when the tree had some at build time), compiler, flags, cpu, cores, package versions, time.
nlohmann::ordered_json manifest();

}  // namespace orthant
