// core/mechanics/spatial/polyhedron.h — mass properties of a homogeneous polyhedron; its contacts: touch.h.
//
//   Σ over the surface's triangles (a, b, c) of the tetrahedron (0, a, b, c), signed, d = a · (b × c):
//   V = Σ d/6,   V x̄ = Σ d/24 s,   ∫ x xᵀ = Σ d/120 (a aᵀ + b bᵀ + c cᵀ + s sᵀ),   s = a + b + c
//   Inertia about the centre: tr(C) 1 − C,  C = ∫ x xᵀ / V − x̄ x̄ᵀ.   The origin is moved to the points' mean first.
// Source: Blow & Binstock, How to find the inertia tensor (or other mass properties) of a 3D solid body (2004).
#pragma once

#include <orthant/core/mechanics/spatial/hull.h>

#include <array>

namespace orthant::spatial {

using Triangle = std::array<Vector3d, 3>;  // [m] counter-clockwise, seen from outside

struct Polyhedron {
  double volume = 0;                                  // [m³]; ≤ 0: the surface is open or inside out
  Vector3d centre{0, 0, 0};                           // [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // [m²] of 1 kg about the centre
};

Polyhedron polyhedron(const std::vector<Triangle>& surface);
Polyhedron polyhedron(const Hull& hull);

}  // namespace orthant::spatial
