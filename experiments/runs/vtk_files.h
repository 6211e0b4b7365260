// experiments/runs/vtk_files.h — VTK files of a run for ParaView: index NAME.pvd, NAME/NAME_i.vtu a moment.
//
//   Files get temporary names, then their own by two renames: a failure before them leaves an earlier result as it was
//   and nothing else, a kill may leave NAME.tmp* and NAME.pvd.tmp*, which the next run onto this name removes. Files of
//   others in the folder NAME stay.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>

#include <filesystem>
#include <vector>

namespace orthant {

/// `table` has `width` columns: t, then x, y, θ, ẋ, ẏ, ω of each body, then others. Throws std::runtime_error.
void write_vtk(const std::filesystem::path& file, const Scene& scene, std::size_t width,
               const std::vector<double>& table);

/// In space: surfaces of solids.h as polygons; t, then x, y, z, quaternion, velocity, ω of each body, then others.
void write_vtk(const std::filesystem::path& file, const spatial::Scene& scene, std::size_t width,
               const std::vector<double>& table);

}  // namespace orthant
