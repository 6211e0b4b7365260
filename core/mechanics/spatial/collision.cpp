#include <orthant/core/mechanics/spatial/collision.h>
#include <orthant/core/mechanics/spatial/exposure.h>

#include <map>

namespace orthant::spatial {

std::vector<SpherePlane> shape_plane(SpherePlane plane, const Shape& shape) {
  plane.radius = shape.radius, plane.centre = shape.corners.front();
  if (shape.sphere()) return {plane};
  std::vector<SpherePlane> all = corners_plane(plane, shape.corners);
  for (SpherePlane& one : all) one.radius = shape.radius;
  return all;
}

void set_hulls(Collision& collision) {
  std::vector<std::shared_ptr<Hull>> hulls(collision.shapes.size());
  std::map<BodyId, std::vector<Hull*>> of_body;
  for (std::size_t i = 0; i < hulls.size(); ++i)
    if (const Shape& shape = collision.shapes[i]; shape.polytope()) {
      hulls[i] = std::make_shared<Hull>(hull_of(shape.corners));
      of_body[shape.body].push_back(hulls[i].get());
    }
  for (const auto& [body, polytopes] : of_body) expose(polytopes);
  for (std::size_t i = 0; i < hulls.size(); ++i) collision.shapes[i].hull = hulls[i];
}

}  // namespace orthant::spatial
