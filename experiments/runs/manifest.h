// experiments/runs/manifest.h — manifest: revision, build, machine and packages on which a result depends.
#pragma once

#include <nlohmann/json.hpp>

namespace orthant {

/// revision (with "+changes" when the tree had some at build time), compiler, flags, cpu, cores, package versions,
/// time.
nlohmann::ordered_json manifest();

}  // namespace orthant
