// core/mechanics/spatial/height_field.h — height field: terrain on a grid, as polytopes of one body.
//
//   The point (i, j) of the grid stands at  origin + (i dx, j dy, heights(i, j)).  Each cell has two triangles, split
//   from (i, j) to (i + 1, j + 1). A triangle is the top of a prism that reaches `depth` below the lowest height. The
//   prisms' common faces and flat seams take no part (exposure.h), so that the terrain acts as one surface.
#pragma once

#include <orthant/core/mechanics/spatial/touch.h>

#include <Eigen/Core>

#include <vector>

namespace orthant::spatial {

struct HeightField {
  Vector3d origin{0, 0, 0};  // [m] in the body's frame
  double dx = 1, dy = 1;     // [m] > 0
  Eigen::MatrixXd heights;   // [m] at least 2 × 2: a row for each place along x
  double depth = 1;          // [m] > 0
};

/// Two shapes of `body` for each cell.
std::vector<Shape> shapes_of(const HeightField& field, BodyId body);

}  // namespace orthant::spatial
