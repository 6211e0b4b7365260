// tests/integrators/derivatives/run_trials.h — scenes by a parameter.
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

}  // namespace orthant
