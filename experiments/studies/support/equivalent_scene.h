// experiments/studies/support/equivalent_scene.h — equivalent scenes: in another order, place or unit, mirrored.
// For scenes whose joints are Revolute and whose contacts are CornerWall.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

namespace orthant {

/// Turns by `angle`, then shifts; parts of the ground go along, parts of bodies stay with them.
Scene moved(Scene s, double angle, const Vector2d& shift);
/// In the line x = 0.
Scene mirrored(Scene s);
/// Other units of length and mass: powers of two keep every digit.
Scene in_units(Scene s, double length, double mass);
/// Bodies, joints and contacts in the opposite order.
Scene reversed(Scene s);
/// With a far body that never meets anything, and four walls too far away for body 2 to reach.
Scene furnished(Scene s);
/// Every element under another name.
Scene renamed(Scene s);
/// The first joint and the first contact twice.
Scene doubled(Scene s);

}  // namespace orthant
