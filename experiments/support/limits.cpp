#include "experiments/support/limits.h"

#include <cmath>
#include <sstream>

namespace orthant {
namespace {

template <class... Words> std::string words_of(const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  return text.str();
}

}  // namespace

std::vector<std::string> limits_entered(const System& system, const Run& run, std::string_view integrator,
                                        double step) {
  std::vector<std::string> limits;
  const auto& bodies = system.scene().bodies;
  const auto at = [](BodyId b) { return static_cast<std::size_t>(b); };
  std::vector<std::size_t> light(bodies.size()), heavy(bodies.size());  // of each cluster, by its first body
  for (std::size_t b = 0; b < bodies.size(); ++b) light[b] = heavy[b] = b;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::size_t first = at(system.cluster()[b]);
    if (bodies[b].mass < bodies[light[first]].mass) light[first] = b;
    if (bodies[b].mass > bodies[heavy[first]].mass) heavy[first] = b;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (const double ratio = bodies[heavy[b]].mass / bodies[light[b]].mass; ratio > kMassRatio)
      limits.push_back(words_of("\"", bodies[heavy[b]].name, "\" has ", ratio, " times the mass of \"",
                                bodies[light[b]].name, "\": beyond ", kMassRatio,
                                " contacts between such bodies may not be solved"));
  if (run.crossings > 0)
    limits.push_back(words_of("crowds of events were crossed in ", run.crossings,
                              run.crossings == 1 ? " step" : " steps",
                              " of first order, whatever the tolerance: the motion may depend on that"));
  double far = 0, turned = 0;
  for (const State& x : {system.initial_state(), run.final})
    for (Index i = 0; i < x.q.size(); ++i) {
      double& most = i % 3 != 2 ? far : turned;
      most = std::max(most, std::abs(x.q[i]));
    }
  if (far > kFar)
    limits.push_back(words_of("bodies are ", far, " m from the origin: places are rounded to ", far * 0x1p-52,
                              " m, rates to that over the step"));
  if (turned > kFar)
    limits.push_back(words_of("bodies are turned by ", turned, " rad: angles are rounded to ", turned * 0x1p-52,
                              " rad, rates to that over the step"));
  if (integrator.starts_with("adaptive") || integrator.starts_with("event-driven")) return limits;

  const auto swing = [&](const auto& spring) {
    if constexpr (requires { spring.a; }) {  // others hang between joints
      constexpr bool turns = !requires { spring.point_a; };
      const auto inverse = [&](BodyId b) {
        return b < 0 ? 0 : 1 / (turns ? bodies[at(b)].inertia : bodies[at(b)].mass);
      };
      return step * std::sqrt(spring.stiffness * (inverse(spring.a) + inverse(spring.b)));
    }
    return 0.0;
  };
  for (const Spring& spring : system.scene().springs)
    if (const double angle = std::visit(swing, spring); angle > kSwing)
      limits.push_back(words_of("spring \"", std::visit([](const auto& s) { return s.name; }, spring), "\" swings by ",
                                angle,
                                " rad in a step: its motion is not followed, and beside contacts energy may rise"));
  double turn = 0;
  std::size_t fastest = 0;
  for (const State& x : {system.initial_state(), run.final})
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (const double by = step * std::abs(x.v[static_cast<Index>(3 * b + 2)]); by > turn) turn = by, fastest = b;
  if (turn > kTurn)
    limits.push_back(
        words_of("\"", bodies[fastest].name, "\" turns by ", turn, " rad in a step: a smaller step is right"));
  return limits;
}

}  // namespace orthant
