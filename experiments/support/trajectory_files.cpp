#include "trajectory_files.h"

#include "trajectory.h"
#include "vtk_files.h"

#include <orthant/core/support/file.h>
#include <orthant/core/lcp/files/hdf5_image.h>

namespace orthant {
namespace {

namespace fs = std::filesystem;

std::string hdf5_of(const std::vector<std::string>& columns, const std::vector<double>& table) {
  Hdf5Image out;
  std::vector<double> column(table.size() / columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = table[i * columns.size() + c];
    out.numbers(columns[c], column);
  }
  return out.bytes();
}

}  // namespace

void check_trajectory_file(const fs::path& file) {
  for (const char* end : {".csv", ".h5", ".hdf5", ".pvd"})
    if (file.extension() == end) return;
  throw std::invalid_argument(file.string() + ": must end in .csv, .h5, .hdf5 or .pvd");
}

void write_trajectory(const fs::path& file, const Scene& scene, const std::vector<std::string>& columns,
                      const std::vector<double>& table) {
  check_trajectory_file(file);
  const fs::path end = file.extension();
  if (end == ".h5" || end == ".hdf5") return write_whole(file, hdf5_of(columns, table));
  if (end == ".pvd") return write_vtk(file, scene, columns.size(), table);
  write_whole(file, to_csv(columns, table));
}

}  // namespace orthant
