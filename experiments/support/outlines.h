// experiments/support/outlines.h — what a scene's bodies look like: what its joints and contacts say of them, drawn.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

#include <vector>

namespace orthant {

struct Outline {
  BodyId body = kGround;
  bool closed = false;            // an area, else a line
  std::vector<Vector2d> corners;  // [m] in the body's frame
};

/// Discs, polygons and guides' corners as areas, lines from the centre of mass to each joint, walls as lines as long as
/// the scene is wide. What is told twice is drawn once.
std::vector<Outline> outlines(const Scene& scene);

}  // namespace orthant
