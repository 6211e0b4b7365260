// experiments/runs/problem_file.h — problem file in any of the formats.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <filesystem>
#include <string>

namespace orthant {

/// M and q of rows [0, infinity): "M.mtx+q.mtx", or NAME.mtx alone where NAME_q.mtx or NAME_b.mtx stands next to it.
Lcp read_matrix_market_problem(const std::string& files);

/// By the name's end: .mtx as above, .hdf5, .h5 FCLIB (core/lcp/files/io_fclib.h), else JSON (core/lcp/files/io.h).
Lcp read_problem_file(const std::filesystem::path& file);

}  // namespace orthant
