// core/mechanics/models/hulls.h — convex hulls of a model's meshes: each file is read once, each deviation is noted.
#pragma once

#include <orthant/core/mechanics/models/files.h>
#include <orthant/core/mechanics/models/mesh.h>

#include <map>

namespace orthant::models {

struct MeshHull {
  std::vector<Vector3d> corners;  // at most 64; empty: the file is of another format
  spatial::Polyhedron solid;      // of the mesh where it is closed, else of its hull
  std::string note;               // what was lost; empty: nothing
};

/// Convex hull and mass of a mesh, its points scaled. Throws std::invalid_argument, with `who` in front, of points in
/// one plane.
MeshHull hull_of_mesh(Mesh mesh, const Vector3d& scale, const std::string& who);

class MeshHulls {
 public:
  explicit MeshHulls(ModelFiles& files) : files_(files) {}
  const MeshHull& get(const XmlElement& element, const XmlAttribute& attribute, const Vector3d& scale,
                      const std::filesystem::path& below = {});

  /// Of all meshes.
  std::vector<std::string> notes() const;

 private:
  ModelFiles& files_;
  std::map<std::string, MeshHull> hulls_;  // by file and scale
};

}  // namespace orthant::models
