// tests/integrators/derivatives/run_trials.h — scenes for derivatives of runs, from text and by a parameter.
#pragma once

#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/run_adjoint.h>
#include <orthant/integrators/derivatives/run_tangent.h>
#include <orthant/solvers/registry.h>

#include <cstdio>

#include "tests/support/scene_texts.h"

namespace orthant {

using MakeScene = std::function<Scene(const std::vector<std::string>&)>;

inline MakeScene from_text(const std::string& text) {
  return [text](const std::vector<std::string>& sets) { return parse_scene(text, sets, "scene"); };
}

/// An arm on a pin with dry friction, on a spring to a ball that strikes a moving belt.
inline const std::string kArmAndBall = R"(
gravity = [0, -9.81]
[[body]]
name = "arm"
mass = 1.3
inertia = 0.2
position = [0.5, 0]
[[body]]
name = "ball"
mass = 0.7
inertia = 0.03
position = [1.3, 0.4]
velocity = [0.4, -1]
omega = 2
[[joint]]
name = "pin"
type = "revolute"
bodies = ["ground", "arm"]
point_b = [-0.5, 0]
[[spring]]
name = "coil"
type = "point"
bodies = ["arm", "ball"]
point_a = [0.4, 0]
stiffness = 30
damping = 0.6
rest = 0.5
[[friction]]
name = "bearing"
joint = "pin"
bound = 0.4
[[contact]]
name = "floor"
type = "disc-wall"
body = "ball"
radius = 0.2
wall = {point = [0, -0.1], normal = [0, 1]}
mu = 0.1
e_n = 0.6
e_t = 0.2
belt = 1.5
)";

}  // namespace orthant
