// core/scenes/oscillator.h — oscillator: a point mass on a linear spring along x; common part of the oscillator scenes.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

/// Body 0, at (x, 0); the spring's force is −stiffness (x, y): slack at the origin, where it is fixed.
inline Scene oscillator(double mass, double stiffness, const Motion& start) {
  Scene s;
  s.body({.name = "mass", .mass = mass, .inertia = mass, .position = {start.x, 0}, .velocity = {start.v, 0}});
  s.spring(PointSpring{"spring", 0, kGround, {0, 0}, {0, 0}, stiffness, 0, 0});
  return s;
}

}  // namespace orthant
