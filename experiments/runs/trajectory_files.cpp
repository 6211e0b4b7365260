#include "experiments/runs/trajectory_files.h"

#include "experiments/runs/drawing.h"
#include "experiments/runs/event_table.h"
#include "experiments/runs/trajectory.h"
#include "experiments/runs/vtk_files.h"

#include <orthant/core/lcp/files/hdf5_image.h>
#include <orthant/core/support/file.h>

namespace orthant {
namespace {

namespace fs = std::filesystem;

template <class Scene> std::string hdf5_of(const Scene& scene, const std::vector<std::string>& columns,
                                           const std::vector<double>& table, const std::vector<Event>& events) {
  Hdf5Image out;
  std::vector<double> column(table.size() / columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = table[i * columns.size() + c];
    out.numbers(columns[c], column);
  }
  out.group("scene");
  out.text("scene/drawing", drawing(scene).dump());
  if (!events.empty()) events_to_hdf5(scene, events, out);
  return out.bytes();
}

}  // namespace

void check_trajectory_file(const fs::path& file) {
  for (const char* end : {".csv", ".h5", ".hdf5", ".pvd"})
    if (file.extension() == end) return;
  throw std::invalid_argument(file.string() + ": must end in .csv, .h5, .hdf5 or .pvd");
}

template <class Scene> void write_trajectory(const fs::path& file, const Scene& scene,
                                             const std::vector<std::string>& columns, const std::vector<double>& table,
                                             const std::vector<Event>& events) {
  check_trajectory_file(file);
  const fs::path end = file.extension();
  if (end == ".h5" || end == ".hdf5") return write_whole(file, hdf5_of(scene, columns, table, events));
  if (end == ".pvd")
    write_vtk(file, scene, columns.size(), table);
  else
    write_whole(file, to_csv(columns, table));
  if (const fs::path beside_it = events_file_of(file); !events.empty() || fs::exists(beside_it))
    write_whole(beside_it, events_to_csv(scene, events));
}
template void write_trajectory(const fs::path&, const Scene&, const std::vector<std::string>&,
                               const std::vector<double>&, const std::vector<Event>&);
template void write_trajectory(const fs::path&, const spatial::Scene&, const std::vector<std::string>&,
                               const std::vector<double>&, const std::vector<Event>&);

}  // namespace orthant
