// experiments/runs/trajectory_files.h — trajectory files: the table of a run, in the format of the file name.
//
//   .csv        one line a moment, numbers in their shortest exact form
//   .h5, .hdf5  HDF5: one array of doubles a column, named as the column; text scene/drawing (drawing.h)
//   .pvd        VTK for ParaView: an index of the moments, and NAME.vtu files in a folder NAME, one a moment, with the
//               bodies' outlines, in space surfaces, in place (cells), their number, velocity [m/s] and angular
//               velocity [rad/s]
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/integrators/event.h>

#include <filesystem>
#include <string>
#include <vector>

namespace orthant {

/// Throws std::invalid_argument where the name ends in none of these: before a long run, not after it.
void check_trajectory_file(const std::filesystem::path& file);

/// `columns` and `table` as trajectory.h has them. Whole or not at all; throws std::runtime_error, or as above.
/// `events` are written next to the trajectory (event_table.h): in the HDF5 file itself, else in NAME.events.csv.
/// Without events there is no such file, and an earlier run's is emptied to its header.
/// Scene: Scene or spatial::Scene.
template <class Scene> void write_trajectory(const std::filesystem::path& file, const Scene& scene,
                                             const std::vector<std::string>& columns, const std::vector<double>& table,
                                             const std::vector<Event>& events = {});

}  // namespace orthant
