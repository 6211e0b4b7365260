// Meshes in a spatial scene file: convex hulls and solids of STL and OBJ files in the scene's folder.
#include "spatial_fields.h"
#include "spatial_reader.h"

#include <orthant/core/mechanics/models/hulls.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>

namespace orthant::scene_file {

bool SpatialReader::names_mesh(Fields& f) {
  const bool named = f.find("file", Form::word) != nullptr;
  if (!named) f.report("scale", Form::any), f.report("centre", Form::triple);
  return named;
}

/// `file`, `scale` (one number, or one for each axis). Each file and scale is read once.
const models::MeshHull& SpatialReader::mesh(Fields& f) {
  const toml::node& node = *f.table().get("file");
  std::string name;
  f.need("file", name);
  if (name.empty() || name.find('\0') != std::string::npos) f.refuse("file", node, "the name of a file");
  double all = 1;
  Vector3d scale(1, 1, 1);
  if (const toml::node* given = f.table().get("scale"); given != nullptr && given->is_array())
    f.maybe("scale", scale);
  else if (f.maybe("scale", all))
    scale.setConstant(all);
  if (!(scale.cwiseAbs().minCoeff() > 0)) f.refuse("scale", *f.table().get("scale"), "not 0");
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_regular_file(file_, error)) f.refuse("file", node, "left out: a scene without a file names no others");
  const fs::path folder = fs::canonical(file_).parent_path(), found = fs::weakly_canonical(folder / name, error);
  if (error || !lies_in(found, folder)) f.refuse("file", node, "in the folder of the scene, " + folder.string());
  std::string key = found.string();
  for (const double s : scale) key += " " + detail::text_of(s);
  if (const auto known = meshes_.find(key); known != meshes_.end()) return known->second;
  const std::string who = found.filename().string();
  std::string bytes;
  try {
    bytes = read_whole(found, largest_input(models::kLargestMesh));
  } catch (const std::runtime_error& reason) {
    f.refuse("file", node, std::string("a file that can be read: ") + reason.what());
  }
  try {
    models::Mesh mesh = models::read_mesh(bytes, who);
    if (mesh.points.empty()) f.refuse("file", node, "a mesh in STL or OBJ");
    auto hull = models::hull_of_mesh(std::move(mesh), scale, who);
    if (!hull.note.empty()) scene_.notes.push_back(hull.note);
    return meshes_.emplace(key, std::move(hull)).first->second;
  } catch (const std::invalid_argument& reason) {
    const std::string why = reason.what();
    if (why.starts_with(file_)) throw;
    f.fail(node, "file: " + why);
  }
}

/// Corners in the body's frame: those of the file, or moved so that its centre of mass is at `centre`.
std::vector<Vector3d> SpatialReader::mesh_corners(Fields& f) {
  const models::MeshHull& hull = mesh(f);
  std::vector<Vector3d> corners = hull.corners;
  Vector3d centre(0, 0, 0);
  if (f.maybe("centre", centre))
    for (Vector3d& corner : corners) corner += centre - hull.solid.centre;
  return corners;
}

}  // namespace orthant::scene_file
