#include <orthant/core/mechanics/models/hulls.h>

#include "target.h"

// STL where it begins as one, else OBJ; then its hull and mass.
bool orthant::fuzz::mesh(std::string_view bytes) {
  const auto try_hull = [](models::Mesh mesh) {
    if (mesh.points.size() <= 2000) static_cast<void>(models::hull_of_mesh(std::move(mesh), {1, 2, -1}, "mesh"));
  };
  const bool stl = parse([&] { try_hull(models::read_stl(bytes, "mesh.stl")); });
  const bool obj = parse([&] { try_hull(models::read_obj(bytes, "mesh.obj")); });
  return stl || obj;
}
