#include <orthant/integrators/derivatives/run_tangent.h>

#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

NearbySystems systems_near(const RunParameter& parameter) {
  NearbySystems nearby;
  if (!parameter.scene) return nearby;
  nearby.step = parameter.value != 0 ? 1e-3 * std::abs(parameter.value) : 1e-5;
  for (const int k : {-2, -1, 1, 2}) {
    const double value = parameter.value + k * nearby.step;
    try {
      nearby.at[static_cast<std::size_t>(k < 0 ? k + 2 : k + 1)] = std::make_unique<System>(parameter.scene(value));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("derivative with respect to " + parameter.name +
                                  ": the scene must exist on both sides of its value: " + error.what());
    }
  }
  return nearby;
}

}  // namespace

RunTangent differentiate_run(const System& system, const std::vector<RunParameter>& parameters,
                             const MoreauJeanOptions& options, Solver& solver, const Clock& clock,
                             const TangentRecorder& record) {
  std::vector<NearbySystems> nearby;
  const auto count = static_cast<Index>(parameters.size());
  RunTangent result;
  result.q.setZero(system.dof(), count), result.v.setZero(system.dof(), count);
  for (Index j = 0; j < count; ++j) {
    const RunParameter& parameter = parameters[at(j)];
    nearby.push_back(systems_near(parameter));
    if (parameter.start < 0) continue;
    if (parameter.start >= 2 * system.dof())
      throw std::invalid_argument("derivative with respect to " + parameter.name + ": start must be below " +
                                  std::to_string(2 * system.dof()));
    (parameter.start < system.dof() ? result.q(parameter.start, j) : result.v(parameter.start - system.dof(), j)) = 1;
  }
  MoreauJean integrator(system, options);
  StepTangent tangent(system, options);
  State before;
  bool begun = false;
  Clock each = clock;
  each.every = 1;
  result.run = simulate(integrator, solver, each, [&](const RunSample& moment) {
    if (begun && (!has_answer(moment.report.status) || moment.state.t == before.t)) return;
    if (!begun) {
      tangent.begin(moment.state, nearby, result.q, result.v);
      begun = true;
    } else {
      tangent.advance(integrator, before, moment.state.t - before.t, moment.state, nearby, result.q, result.v);
      if (!tangent.degenerate().empty()) result.degenerate.push_back({before.t, tangent.degenerate()});
      result.inconsistent += !tangent.consistent();
    }
    before = moment.state;
    if (record) record(moment.state, result.q, result.v);
  });
  return result;
}

}  // namespace orthant
