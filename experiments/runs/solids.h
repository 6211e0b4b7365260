// experiments/runs/solids.h — solids of a scene in space: shapes of its bodies by contacts, joints and inertias, for
// drawings and VTK files.
//
//   contact with a sphere  Sphere, in a socket also a hollow one     corners of a body   Polytope, their convex hull
//   plane                  Plane, a square as wide as the scene      joint               Capsule, a thin link from the
//                                                                                        centre of mass to it
//   a body without contact shape   Polytope: the box of its mass and inertia, edges sqrt(6 (J_j + J_k − J_i) / m),
//                                  where the scene is not much smaller than that
#pragma once

#include <orthant/core/mechanics/spatial/scene.h>

#include <variant>
#include <vector>

namespace orthant {

/// Points [m] in the body's frame; each face lists its corners, counter-clockwise from outside.
struct Faces {
  std::vector<Vector3d> points;
  std::vector<std::vector<int>> faces;
};

namespace drawn {

struct Sphere {
  Vector3d centre;
  double radius = 1;  // [m]
  bool hollow = false;
};
struct Capsule {
  Vector3d from, to;
  double radius = 1;
};
struct Polytope : Faces {};
struct Plane {
  Vector3d point, normal;  // the middle of the square that is drawn
  double half = 1;         // [m] half its edge
};

}  // namespace drawn

/// All in the frame of the body.
struct DrawnSolid {
  BodyId body = kGround;
  std::variant<drawn::Sphere, drawn::Capsule, drawn::Polytope, drawn::Plane> shape;
};

/// Each solid once.
std::vector<DrawnSolid> solids(const spatial::Scene& scene);

/// The solid's surface in flat faces: spheres and round ends approximated.
Faces surface(const DrawnSolid& solid);

/// Convex hull of points: faces in one plane are one polygon; of points in one plane that polygon alone; of points in
/// one line no face. Of more than 60 corners those stay that leave least outside (spatial/hull.h).
Faces convex_hull(const std::vector<Vector3d>& points);

}  // namespace orthant
