// Exact cases of linkages: pendulums, chains, four-bars and the slider-crank.
#include "experiments/studies/exact_cases/case_groups.h"

#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/slider_crank_exact.h>

#include <cmath>

namespace orthant {
namespace {

double error_of(const ChainExact& exact, const State& x) {
  const Vector2d tip{x.q[3 * exact.links - 3], x.q[3 * exact.links - 2]};
  return std::hypot(tip.x() - exact.tip[0], tip.y() - exact.tip[1]);
}

}  // namespace

void linkage_cases(std::vector<ExactCase>& all) {
  const Pendulum swing{};
  all.push_back({.id = "B14",
                 .title = "pendulum from 3 rad, one period",
                 .measure = "angle error at the end [rad]",
                 .scene = pendulum(swing),
                 .duration = swing.period(),
                 .h = swing.period() / 500,
                 .error =
                     [swing](const RunSample& m) {
                       return std::abs(std::atan2(m.state.q[kX], -m.state.q[kY]) - swing.at(m.state.t).x);
                     },
                 .motion = ExactCase::Motion::smooth,
                 .energy = ExactCase::Energy::conserved});
  for (const ChainExact& exact : chain_exact())
    all.push_back({.id = "B14",
                   .title = "chain of " + std::to_string(exact.links) + " links let go from the horizontal",
                   .measure = "distance of the tip at " + std::to_string(static_cast<int>(exact.t)) + " s [m]",
                   .scene = chain({.links = exact.links}),
                   .duration = exact.t,
                   .h = 2e-3,
                   .error = [exact](const RunSample& m) { return error_of(exact, m.state); },
                   .motion = ExactCase::Motion::smooth,
                   .energy = ExactCase::Energy::conserved});
  const NFourBar bars;
  all.push_back(
      {.id = "B15",
       .title = "two parallelograms through their singular poses, 10 s",
       .measure = "crank angle error at the end [rad]",
       .scene = n_four_bar(bars),
       .duration = 10,
       .h = 4e-3,
       .error = [bars](const RunSample& m) { return std::abs(std::abs(m.state.q[kTheta]) - bars.at(m.state.t).x); },
       .motion = ExactCase::Motion::smooth,
       .energy = ExactCase::Energy::conserved});
}

void slider_crank_cases(std::vector<ExactCase>& all) {
  for (const auto& [mu, e] : {std::pair{0.01, 0.4}, std::pair{0.1, 0.0}}) {
    const SliderCrankExact exact = *slider_crank_exact(mu, e);
    all.push_back({.id = "SC",
                   .title = "slider-crank with clearance, e = " + std::string(e == 0 ? "0" : "0.4"),
                   .measure = "crank angle error at 0.2 s [rad]",
                   .scene = slider_crank({.mu = mu, .e = e}),
                   .duration = 0.2,
                   .h = 2e-4,
                   .error = [exact](const RunSample& m) { return std::abs(m.state.q[kTheta] - exact.theta1); }});
  }
}

}  // namespace orthant
