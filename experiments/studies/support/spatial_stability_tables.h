// experiments/studies/support/spatial_stability_tables.h — numerical stability in space as files: a row a run, and a
// table a study.
#pragma once

#include <filesystem>
#include <string>

namespace orthant {

struct SpatialStabilityPlan {
  std::filesystem::path output;
  bool quick = false;
  double time_limit = 60;  // [s] of each run
  std::string only;        // studies whose name has this text
};

/// Writes stability.csv and stability.md, and returns the text of the latter. Throws std::invalid_argument where no
/// study has the name.
std::string spatial_stability(const SpatialStabilityPlan& plan);

}  // namespace orthant
