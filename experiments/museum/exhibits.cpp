#include "experiments/museum/exhibit.h"

#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/scenes/stick_slip.h>

#include <cmath>
#include <numbers>

namespace orthant {
namespace {

using Energy = Exhibit::Energy;
using Kind = Exhibit::Motion;

constexpr Index kX = 0, kY = 1, kTheta = 2;  // of body 0

/// |q_k − x*(t)| of a scene whose exact motion is at(t).
template <class Scenario> auto along(const Scenario& p, Index k) {
  return [p, k](const Moment& m) { return std::abs(m.state.q[k] - p.at(m.state.t).x); };
}

void balls(std::vector<Exhibit>& all) {
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
                 .energy = Energy::conserved});
}

void friction(std::vector<Exhibit>& all) {
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
                 .error = [](const Moment& m) { return std::abs(m.state.v[kX]); },
                 .throughout = true,
                 .exact = 1e-12});
  all.push_back({.id = "B3",
                 .title = "block just not held by friction",
                 .measure = "speed error at 1 s [m/s]",
                 .scene = incline(slides),
                 .duration = 1,
                 .h = 1e-2,
                 .error = [slides](const Moment& m) { return std::abs(m.state.v[kX] - slides.at(m.state.t).v); },
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
                 .energy = Energy::driven});
  all.push_back({.id = "B4",
                 .title = "swings that friction ends: the place where it stops for ever",
                 .measure = "position error + speed at the end [m, m/s]",
                 .scene = coulomb_decay(decay),
                 .duration = 25,
                 .h = 2e-2,
                 .error = [](const Moment& m) { return std::abs(m.state.q[kX] + 0.2) + std::abs(m.state.v[kX]); }});
}

void driven(std::vector<Exhibit>& all) {
  const ImpactOscillator oscillator;
  all.push_back({.id = "B10",
                 .title = "impact oscillator on its periodic motion, ten periods",
                 .measure = "position error at the end [m]",
                 .scene = impact_oscillator(oscillator),
                 .duration = 10.25 * oscillator.period(),
                 .h = oscillator.period() / 200,
                 .error = along(oscillator, kX),
                 .energy = Energy::driven});
}

double error_of(const ChainExact& exact, const State& x) {
  const Vector2d tip{x.q[3 * exact.links - 3], x.q[3 * exact.links - 2]};
  return std::hypot(tip.x() - exact.tip[0], tip.y() - exact.tip[1]);
}

void loops_and_chains(std::vector<Exhibit>& all) {
  const Pendulum swing{};
  all.push_back({.id = "B14",
                 .title = "pendulum from 3 rad, one period",
                 .measure = "angle error at the end [rad]",
                 .scene = pendulum(swing),
                 .duration = swing.period(),
                 .h = swing.period() / 500,
                 .error =
                     [swing](const Moment& m) {
                       return std::abs(std::atan2(m.state.q[kX], -m.state.q[kY]) - swing.at(m.state.t).x);
                     },
                 .motion = Kind::smooth,
                 .energy = Energy::conserved});
  for (const ChainExact& exact : chain_exact())
    all.push_back({.id = "B14",
                   .title = "chain of " + std::to_string(exact.links) + " links let go from the horizontal",
                   .measure = "distance of the tip at " + std::to_string(static_cast<int>(exact.t)) + " s [m]",
                   .scene = chain({.links = exact.links}),
                   .duration = exact.t,
                   .h = 2e-3,
                   .error = [exact](const Moment& m) { return error_of(exact, m.state); },
                   .motion = Kind::smooth,
                   .energy = Energy::conserved});
  const NFourBar bars;
  all.push_back(
      {.id = "B15",
       .title = "two parallelograms through their singular poses, 10 s",
       .measure = "crank angle error at the end [rad]",
       .scene = n_four_bar(bars),
       .duration = 10,
       .h = 4e-3,
       .error = [bars](const Moment& m) { return std::abs(std::abs(m.state.q[kTheta]) - bars.at(m.state.t).x); },
       .motion = Kind::smooth,
       .energy = Energy::conserved});
}

void slider_cranks(std::vector<Exhibit>& all) {
  for (const auto& [mu, e] : {std::pair{0.01, 0.4}, std::pair{0.1, 0.0}}) {
    const SliderCrankExact exact = *slider_crank_exact(mu, e);
    all.push_back({.id = "SC",
                   .title = "slider-crank with clearance, e = " + std::string(e == 0 ? "0" : "0.4"),
                   .measure = "crank angle error at 0.2 s [rad]",
                   .scene = slider_crank({.mu = mu, .e = e}),
                   .duration = 0.2,
                   .h = 2e-4,
                   .error = [exact](const Moment& m) { return std::abs(m.state.q[kTheta] - exact.theta1); }});
  }
}

}  // namespace

std::vector<Exhibit> exhibits() {
  std::vector<Exhibit> all;
  balls(all);
  friction(all);
  driven(all);
  loops_and_chains(all);
  slider_cranks(all);
  return all;
}

}  // namespace orthant
