// experiments/runs/drawing.h — drawing of a scene as JSON: for animations in reports, views and HDF5 files of runs.
//
//   bodies          [{name}]
//   outlines        [{body, closed, wall, points}]  of outlines.h; body −1: the ground; points [m] in the body's frame
//   pins            [{a, point_a, body, point}]
//   contacts        [{name}] in the order of a run's columns, with the place of the force where it follows from poses:
//                     a point on a wall   body, point; wall, normal of the body `on` (ground: `on` is the ground)
//                     two round bodies    centres: {a, point_a, radius_a, b, point_b, radius_b, inside}
//   event_contacts  names that events have: contacts, collisions, joints' frictions
//
// In space: dimension: 3, and
//   bodies          [{name}]
//   solids          [{body, kind, …}]  of solids.h, in the body's frame; by kind
//                     sphere, socket: centre, radius    capsule: from, to, radius
//                     polytope: points, faces           plane: point, normal, half (of the square's edge)
//   joints          [{name, kind, a, point_a, body, point, axis}]  no drives; axis in a's frame, where there is one
//   contacts        [{name, mu}] in the order of a run's columns, with
//                     a sphere or corner on a plane   body, point, radius; normal of the body `on`
//                     two spheres                     centres, as above
//   event_contacts  names of the contacts
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>

#include <nlohmann/json.hpp>

namespace orthant {

nlohmann::ordered_json drawing(const Scene& scene);
nlohmann::ordered_json drawing(const spatial::Scene& scene);

}  // namespace orthant
