// Exact cases of one body: bounces, friction, rolling, the Painleve rod and rocking.
#include "experiments/studies/exact_cases/case_groups.h"

#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/painleve_rod.h>
#include <orthant/core/scenes/rocking_block.h>
#include <orthant/core/scenes/roll.h>
#include <orthant/core/scenes/stick_slip.h>

#include <cmath>
#include <numbers>

namespace orthant {

void ball_cases(std::vector<ExactCase>& all) {
  const BouncingBall plastic{.e = 0.5}, elastic{.e = 1};
  all.push_back({.id = "B1",
                 .title = "bouncing ball, e = 1/2, past the accumulation of its impacts",
                 .measure = "largest height error [m]",
                 .scene = bouncing_ball(plastic),
                 .duration = 2,
                 .h = 1e-2,
                 .error = along(plastic, kY),
                 .throughout = true});
  all.push_back({.id = "B2",
                 .title = "elastic ball, seven impacts",
                 .measure = "largest height error [m]",
                 .scene = bouncing_ball(elastic),
                 .duration = 6,
                 .h = 1e-2,
                 .error = along(elastic, kY),
                 .throughout = true,
                 .energy = ExactCase::Energy::conserved});
}

void friction_cases(std::vector<ExactCase>& all) {
  const double critical = std::tan(std::numbers::pi / 6);
  const Incline up{.mu = 0.5, .speed = 2}, holds{.mu = critical + 1e-6, .speed = 0},
      slides{.mu = critical - 1e-6, .speed = 0};
  all.push_back({.id = "B3",
                 .title = "block sent up a slope: stops, slides back",
                 .measure = "largest position error [m]",
                 .scene = incline(up),
                 .duration = 1,
                 .h = 1e-2,
                 .error = along(up, kX),
                 .throughout = true});
  all.push_back({.id = "B3",
                 .title = "block just held by friction: no creep",
                 .measure = "largest speed [m/s]",
                 .scene = incline(holds),
                 .duration = 1,
                 .h = 1e-2,
                 .error = [](const RunSample& m) { return std::abs(m.state.v[kX]); },
                 .throughout = true,
                 .exact = 1e-12});
  all.push_back({.id = "B3",
                 .title = "block just not held by friction",
                 .measure = "speed error at 1 s [m/s]",
                 .scene = incline(slides),
                 .duration = 1,
                 .h = 1e-2,
                 .error = [slides](const RunSample& m) { return std::abs(m.state.v[kX] - slides.at(m.state.t).v); },
                 .exact = 1e-12});
  const StickSlip belt;
  const CoulombDecay decay;
  all.push_back({.id = "B4",
                 .title = "stick-slip on a belt, two periods",
                 .measure = "largest position error [m]",
                 .scene = stick_slip(belt),
                 .duration = 18,
                 .h = 2e-2,
                 .error = along(belt, kX),
                 .throughout = true,
                 .energy = ExactCase::Energy::driven});
  all.push_back({.id = "B4",
                 .title = "swings that friction ends: the place where it stops for ever",
                 .measure = "position error + speed at the end [m, m/s]",
                 .scene = coulomb_decay(decay),
                 .duration = 25,
                 .h = 2e-2,
                 .error = [](const RunSample& m) { return std::abs(m.state.q[kX] + 0.2) + std::abs(m.state.v[kX]); }});
}

void rolling_cases(std::vector<ExactCase>& all) {
  const auto add = [&all](const char* title, const Roll& p) {
    all.push_back({.id = "B5",
                   .title = title,
                   .measure = "largest position error [m]",
                   .scene = roll(p),
                   .duration = 1.5,
                   .h = 1e-2,
                   .error = along(p, kX),
                   .throughout = true});
  };
  const double slope = std::numbers::pi / 6;
  add("sphere slides, then rolls", {});
  add("sphere rolls down 30 degrees, friction just enough", {.mu = 0.165, .speed = 0, .slope = slope});
  add("sphere slides down 30 degrees", {.mu = 0.1, .speed = 0, .slope = slope});
}

void painleve_cases(std::vector<ExactCase>& all) {
  const auto add = [&all](const char* title, const char* word, double omega) {
    all.push_back({.id = "B6",
                   .title = title,
                   .measure = "steps that could not be solved",
                   .scene = painleve_rod({.omega = omega}),
                   .duration = 1e-3,
                   .h = 1e-4,
                   .error = [](const RunSample&) { return 0.0; },
                   .motion = ExactCase::Motion::instant,
                   .word = word});
  };
  add("Painleve's rod, no consistent acceleration: named, and velocity-level steps go on", "none", 0);
  add("Painleve's rod, two consistent accelerations: named, and velocity-level steps go on", "several", 4);
}

void rocking_cases(std::vector<ExactCase>& all) {
  const auto add = [&all](const char* title, const RockingBlock& p, double duration, double h) {
    all.push_back({.id = "B7",
                   .title = title,
                   .measure = "largest angle error [rad]",
                   .scene = rocking_block(p),
                   .duration = duration,
                   .h = h,
                   .error = along(p, kTheta),
                   .throughout = true});
  };
  add("rocking block, four impacts", {}, 1.7, 4e-3);
  const RockingBlock stops{.half_height = 0.07}, lifts{.half_height = 0.072};
  add("block of h/b = 0.70 stops dead", stops, 2 * stops.impact_time(1), stops.impact_time(1) / 50);
  add("block of h/b = 0.72 lifts its other corner", lifts, 1.5 * lifts.impact_time(1), lifts.impact_time(1) / 100);
}

void driven_cases(std::vector<ExactCase>& all) {
  const ImpactOscillator oscillator;
  all.push_back({.id = "B10",
                 .title = "impact oscillator on its periodic motion, ten periods",
                 .measure = "position error at the end [m]",
                 .scene = impact_oscillator(oscillator),
                 .duration = 10.25 * oscillator.period(),
                 .h = oscillator.period() / 200,
                 .error = along(oscillator, kX),
                 .energy = ExactCase::Energy::driven});
}

}  // namespace orthant
