#include "experiments/runs/problem_file.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/lcp/files/io_fclib.h>

#include <stdexcept>

namespace orthant {

Lcp read_matrix_market_problem(const std::string& files) {
  const auto plus = files.find(".mtx+");
  const std::string matrix = plus == std::string::npos ? files : files.substr(0, plus + 4);
  std::string vector = plus == std::string::npos ? "" : files.substr(plus + 5);
  for (const char* end : {"_q.mtx", "_b.mtx"})
    if (const std::string name = matrix.substr(0, matrix.size() - 4) + end;
        vector.empty() && std::filesystem::exists(name))
      vector = name;
  if (vector.empty())
    throw std::invalid_argument(matrix + ": a matrix alone is no problem: must be " + matrix +
                                "+VECTOR.mtx, or have its vector next to it, as NAME_q.mtx or NAME_b.mtx");
  Lcp problem = Lcp::standard(read_matrix_market(matrix), read_matrix_market_vector(vector));
  if (problem.size() != order(problem.A))
    throw std::invalid_argument(vector + ": has " + std::to_string(problem.size()) + " entries: must have " +
                                std::to_string(order(problem.A)) + ", as " + matrix + " has rows");
  check(problem);
  if (!finite(problem)) throw std::invalid_argument(files + ": M and q must be finite");
  return problem;
}

Lcp read_problem_file(const std::filesystem::path& file) {
  const auto end = file.extension();
  if (end == ".mtx") return read_matrix_market_problem(file.string());
  return end == ".hdf5" || end == ".h5" ? read_fclib(file).problem : read_problem(file);
}

}  // namespace orthant
