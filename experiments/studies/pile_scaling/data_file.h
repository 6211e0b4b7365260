// experiments/studies/pile_scaling/data_file.h — the last steps of piles in many ways, as a CSV file.
#pragma once

#include "experiments/studies/pile_scaling/pile_motion.h"

namespace orthant {

/// Each pile takes its last steps by each solver to each tolerance.
struct Cases {
  std::vector<Bodies> kinds;
  std::vector<int> sizes;
  std::vector<std::string> solvers;
  std::vector<double> tolerances;
};

/// Writes the file at `path`, or appends to it. Each line comes from a process of its own, which takes the last steps
/// of a settled pile, and has the status of its end and the hash of its last state. Where the status is not `solved`,
/// time, sweeps and residual are those of the step that ends without an answer.
/// Returns the exit code: 3 where two numbers of threads differ. Cases without an answer are lines.
int write_data(const std::string& path, bool append, const Cases& cases, const Settling& way);

}  // namespace orthant
