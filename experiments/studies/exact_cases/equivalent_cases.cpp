// Exact cases of equivalent formulations: one mechanism, described in two ways.
#include "experiments/studies/exact_cases/case_groups.h"
#include "experiments/studies/support/equivalent_scene.h"

#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/table.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant {

/// Equivalent formulations move alike: the slider-crank's first 20 ms, crank angle; and more friction holds more.
void equivalent_cases(std::vector<ExactCase>& all) {
  const auto add = [&all](const char* id, const char* title, const Scene& original, const Scene& told, auto unlike) {
    all.push_back({.id = id,
                   .title = title,
                   .measure = "difference of the crank angles [rad]",
                   .scene = told,
                   .duration = 0.02,
                   .h = 1e-4,
                   .error = nullptr,
                   .motion = ExactCase::Motion::instant,
                   .energy = ExactCase::Energy::driven,
                   .exact = 1e-10,
                   .original = original,
                   .unlike = unlike});
  };
  const auto apart = [](Index k, double sign, double angle) {
    return [=](const State& a, const State& b) { return std::abs(sign * (a.q[k] - angle) - b.q[kTheta]); };
  };
  const Scene drawn = slider_crank({.mu = 0.1});
  add("C4", "slider-crank, its elements in the opposite order", drawn, reversed(drawn), apart(8, 1, 0));
  add("C4", "slider-crank mirrored", drawn, mirrored(drawn), apart(kTheta, -1, 0));
  add("C4", "slider-crank turned with gravity", drawn, moved(drawn, 0.7, {0, 0}), apart(kTheta, 1, 0.7));
  add("C4", "slider-crank elsewhere", drawn, moved(drawn, 0, {3, -2}), apart(kTheta, 1, 0));
  add("C4", "slider-crank 1000 km away", drawn, moved(drawn, 0, {1e6, 1e6}), apart(kTheta, 1, 0));
  all.back().exact = 1e-2;  // coordinates of 1e6 m are known to 1e-10 m, the guide's clearance is 1 mm
  add("C4", "slider-crank in other units", drawn, in_units(drawn, 1024, 0.25), apart(kTheta, 1, 0));
  add("C4", "slider-crank under other names", drawn, renamed(drawn), apart(kTheta, 1, 0));
  add("C7", "slider-crank, a joint and a contact written twice", drawn, doubled(drawn), apart(kTheta, 1, 0));
  add("C7", "slider-crank, a far body and walls never reached", drawn, furnished(drawn), apart(kTheta, 1, 0));
  add("C7", "slider-crank, no friction written as friction", slider_crank({.mu = 0}), slider_crank({.mu = 1e-14}),
      apart(kTheta, 1, 0));
  const Incline less{.mu = 0.5, .speed = 2}, more{.mu = 0.6, .speed = 2};
  add("C5", "block sent up a slope: more friction, no farther", incline(less), incline(more),
      [](const State& a, const State& b) { return std::max(0.0, a.q[kX] - b.q[kX]); });
  all.back().measure = "how much farther [m]", all.back().duration = 0.25, all.back().h = 1e-3;
  // A pendulum's angle in minimal coordinates, from elliptic functions, against two coordinates and a joint.
  const Pendulum swing;
  all.push_back({.id = "C7",
                 .title = "pendulum: a body and a pin against one angle (B14, B15: chains, loops)",
                 .measure = "largest angle error in 1 s [rad]",
                 .scene = pendulum(swing),
                 .duration = 1,
                 .h = 1e-2,
                 .error =
                     [swing](const RunSample& m) {
                       const double angle = std::atan2(m.state.q[kX], -m.state.q[kY]);
                       return std::abs(std::remainder(angle - swing.at(m.state.t).x, 2 * std::numbers::pi));
                     },
                 .throughout = true,
                 .motion = ExactCase::Motion::smooth,
                 .energy = ExactCase::Energy::conserved});
}

/// A table that drops aslant on more legs than its three coordinates tell apart, without friction: W is symmetric,
/// positive semidefinite and singular, forces are not unique, velocities are.
void solver_cases(std::vector<ExactCase>& all) {
  Scene s = table();
  s.bodies[0].velocity = {0, -1}, s.bodies[0].omega = 0.5;
  for (Contact& contact : s.contacts) std::get<CornerWall>(contact).law.e = 0.5;
  all.push_back({.id = "C6",
                 .title = "table dropped on its four legs: every solver's velocities are Lemke's",
                 .measure = "largest difference of the velocities at 1/2 s [m/s, rad/s]",
                 .scene = s,
                 .duration = 0.5,
                 .h = 0x1p-7,
                 .error = nullptr,
                 .motion = ExactCase::Motion::instant,
                 .exact = 1e-8,
                 .original = s,
                 .rival = "lemke",
                 .unlike = [](const State& a, const State& b) { return (a.v - b.v).lpNorm<Eigen::Infinity>(); }});
}

}  // namespace orthant
