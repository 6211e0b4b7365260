// experiments/support/problem_file.h — a problem from whatever file it is in.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <filesystem>

namespace orthant {

/// By the name's end: .hdf5, .h5 FCLIB (core/lcp/files/io_fclib.h), else a JSON problem file (core/lcp/files/io.h).
Lcp read_problem_file(const std::filesystem::path& file);

}  // namespace orthant
