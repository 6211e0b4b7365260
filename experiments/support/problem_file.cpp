#include "problem_file.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/lcp/files/io_fclib.h>

namespace orthant {

Lcp read_problem_file(const std::filesystem::path& file) {
  const auto end = file.extension();
  return end == ".hdf5" || end == ".h5" ? read_fclib(file).problem : read_problem(file);
}

}  // namespace orthant
