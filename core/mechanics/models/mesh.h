// core/mechanics/models/mesh.h — triangle meshes from STL and OBJ files: points and surface, for hulls and masses.
//
//   STL   binary (80 bytes, a count, 50 bytes a triangle) where the size fits the count, else text: `vertex x y z`
//   OBJ   `v x y z`, `f i j k …` with i, i/t, i/t/n, i//n, negative numbers from the end; polygons as fans
// Everything else in an OBJ file (normals, groups, materials) does not affect the shape. Numbers must be finite.
// Throws std::invalid_argument naming file, line or triangle, and rule.
#pragma once

#include <orthant/core/mechanics/spatial/polyhedron.h>

#include <cstdint>
#include <string_view>

namespace orthant::models {

struct Mesh {
  std::vector<Vector3d> points;  // [m] those of STL: three a triangle
  std::vector<spatial::Triangle> surface;
};

inline constexpr std::uintmax_t kLargestMesh = 64 << 20;  // [bytes]

Mesh read_stl(std::string_view bytes, const std::string& file);
Mesh read_obj(std::string_view text, const std::string& file);
/// By the name's ending. Another one: a mesh without points.
Mesh read_mesh(std::string_view bytes, const std::string& file);

/// Every edge is in two triangles, once in each direction: it encloses a volume.
bool closed(const Mesh& mesh);

}  // namespace orthant::models
