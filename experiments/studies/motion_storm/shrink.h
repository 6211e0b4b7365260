// experiments/studies/motion_storm/shrink.h — minimal scenes: the smallest one that still shows a fault.
#pragma once

#include "experiments/studies/motion_storm/space.h"

#include <functional>

namespace orthant::motion_storm {

/// Bodies (with all that is attached to them), joints, contacts, springs and loads are left out, the duration is
/// halved, gravity, speeds, friction and restitution become 0, numbers lose digits, as long as `shows` stays true;
/// until nothing more goes or `tries` are used up. shows(scene) holds at the start; it gets scenes that check() takes.
Scene shrink(Scene scene, const std::function<bool(const Scene&)>& shows, int tries = 400);
spatial::Scene shrink(spatial::Scene scene, const std::function<bool(const spatial::Scene&)>& shows, int tries = 400);

}  // namespace orthant::motion_storm
