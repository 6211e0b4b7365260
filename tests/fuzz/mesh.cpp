#include <orthant/core/mechanics/models/hulls.h>

#include "target.h"

// STL where it begins as one, else OBJ; then its hull and mass.
void orthant::fuzz::mesh(std::string_view bytes) {
  const auto try_hull = [](models::Mesh mesh) {
    if (mesh.points.size() <= 2000) static_cast<void>(models::hull_of_mesh(std::move(mesh), {1, 2, -1}, "mesh"));
  };
  parse([&] { try_hull(models::read_stl(bytes, "mesh.stl")); });
  parse([&] { try_hull(models::read_obj(bytes, "mesh.obj")); });
}
