// core/mechanics/spatial/inertia.h — principal axes of an inertia tensor.
//
//   J = A diag(J1, J2, J3) Aᵀ,   A: principal axes → body's frame, a rotation
// A diagonal tensor keeps its order and A = 1, so that bodies which are given in principal axes stay there to the bit.
#pragma once

#include <orthant/core/mechanics/blocks.h>

namespace orthant::spatial {

struct Principal {
  Vector3d moments;      // [kg m²]
  Eigen::Vector4d axes;  // quaternion of A
};

Principal principal(const Eigen::Matrix3d& tensor);

}  // namespace orthant::spatial
