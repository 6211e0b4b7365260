// core/mechanics/scene/expose.h — internal edges of a scene: polygons that cover each other (planar/exposure.h).
//
//   Solids of one body count as neighbours where the same opponent can meet them: both have a contact with its body, or
//   both are shapes of one collision, walls included.
#pragma once

namespace orthant {

struct Scene;

/// Sets the exposures of all polygons in contacts and collisions.
void expose(Scene& scene);

}  // namespace orthant
