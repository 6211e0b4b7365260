// experiments/support/drawing.h — drawing of a scene as JSON: for animations in reports, views and HDF5 files of runs.
//
//   bodies          [{name}]
//   outlines        [{body, closed, wall, points}]  of outlines.h; body −1: the ground; points [m] in the body's frame
//   pins            [{a, point_a, body, point}]
//   contacts        [{name}] in the order of a run's columns, with the place of the force where it follows from poses:
//                     a point on a wall   body, point; wall, normal of the body `on` (ground: `on` is the ground)
//                     two round bodies    centres: {a, point_a, radius_a, b, point_b, radius_b, inside}
//   event_contacts  names that events have: contacts, then collisions
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

#include <nlohmann/json.hpp>

namespace orthant {

nlohmann::ordered_json drawing(const Scene& scene);

}  // namespace orthant
