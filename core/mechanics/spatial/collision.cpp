#include <orthant/core/mechanics/spatial/collision.h>

namespace orthant::spatial {
namespace {

/// Marks the faces of `hull` that lie in or on `other` with all their corners, and the edges of these.
void cover(Hull& hull, const Hull& other) {
  constexpr double kOn = 1e-9;  // of the size
  for (Hull::Face& face : hull.faces) {
    const bool inside = std::all_of(face.corners.begin(), face.corners.end(), [&](int i) {
      return other.depth_of(hull.corners[static_cast<std::size_t>(i)]) <= kOn * hull.size;
    });
    if (!inside) continue;
    face.covered = hull.any_covered = true;
    for (const int e : face.edges) hull.edges[static_cast<std::size_t>(e)].covered = true;
  }
}

}  // namespace

std::vector<SpherePlane> shape_plane(SpherePlane plane, const Shape& shape) {
  plane.radius = shape.radius, plane.centre = shape.corners.front();
  if (shape.sphere()) return {plane};
  std::vector<SpherePlane> all = corners_plane(plane, shape.corners);
  for (SpherePlane& one : all) one.radius = shape.radius;
  return all;
}

void set_hulls(Collision& collision) {
  std::vector<std::shared_ptr<Hull>> hulls(collision.shapes.size());
  for (std::size_t i = 0; i < hulls.size(); ++i)
    if (collision.shapes[i].polytope()) hulls[i] = std::make_shared<Hull>(hull_of(collision.shapes[i].corners));
  for (std::size_t i = 0; i < hulls.size(); ++i)
    for (std::size_t j = 0; j < hulls.size(); ++j)
      if (i != j && hulls[i] && hulls[j] && collision.shapes[i].body == collision.shapes[j].body)
        cover(*hulls[i], *hulls[j]);
  for (std::size_t i = 0; i < hulls.size(); ++i) collision.shapes[i].hull = hulls[i];
}

}  // namespace orthant::spatial
