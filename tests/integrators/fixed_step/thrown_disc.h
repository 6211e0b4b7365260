// tests/integrators/fixed_step/thrown_disc.h — a disc that is thrown, and its momentum.
#pragma once

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/oscillator.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/support/spline.h>

#include "tests/support/allocations.h"
#include "tests/support/mechanics.h"
#include "tests/support/runs.h"

namespace orthant {

inline constexpr std::string_view kFixedStep[] = {"moreau-jean",     "stewart-trinkle",   "anitescu-potra",
                                                  "paoli-schatzman", "generalized-alpha", "rattle"};

/// A disc above a floor, thrown, no gravity unless told.
inline Scene thrown_disc(const ContactLaw& law, double gap, const Vector2d& velocity, double omega = 0, double g = 0) {
  Scene s{.gravity = {0, -g}};
  s.body({.mass = 2, .inertia = 0.3, .position = {0, 0.5 + gap}, .velocity = velocity, .omega = omega});
  s.contact(DiscWall{"floor", 0, {0, 0}, 0.5, kGround, {0, 0}, {0, 1}, law});
  return s;
}

}  // namespace orthant
