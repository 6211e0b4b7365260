// experiments/runs/outlines.h — outlines of a scene's bodies, by joints and contacts: for VTK files and animations.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

#include <vector>

namespace orthant {

struct Outline {
  BodyId body = kGround;
  bool closed = false;            // an area, else a line
  bool wall = false;              // a line as long as the scene is wide
  std::vector<Vector2d> corners;  // [m] in the body's frame
};

/// Discs (with a radius, to see them turn), polygons and guides' corners as areas, lines from the centre of mass to
/// each joint and journal, walls as lines as long as the scene is wide. Duplicates are drawn once.
std::vector<Outline> outlines(const Scene& scene);

}  // namespace orthant
