#include <orthant/core/mechanics/spatial/height_field.h>

#include <array>
#include <utility>

namespace orthant::spatial {

std::vector<Shape> shapes_of(const HeightField& field, BodyId body) {
  using Place = std::pair<Eigen::Index, Eigen::Index>;
  const double floor = field.heights.minCoeff() - field.depth;
  const auto add = [&](std::vector<Vector3d>& corners, const Place& at) {
    const double x = field.dx * static_cast<double>(at.first), y = field.dy * static_cast<double>(at.second);
    for (const double z : {field.heights(at.first, at.second), floor})
      corners.push_back(field.origin + Vector3d(x, y, z));
  };
  std::vector<Shape> shapes;
  for (Eigen::Index i = 0; i + 1 < field.heights.rows(); ++i)
    for (Eigen::Index j = 0; j + 1 < field.heights.cols(); ++j)
      for (const Place& third : {Place{i + 1, j}, Place{i, j + 1}}) {
        Shape prism{.body = body, .corners = {}};
        for (const Place& at : {Place{i, j}, Place{i + 1, j + 1}, third}) add(prism.corners, at);
        shapes.push_back(std::move(prism));
      }
  return shapes;
}

}  // namespace orthant::spatial
