#include "experiments/runs/run_gradient.h"

#include <orthant/core/support/options.h>
#include <orthant/core/support/shortened.h>

#include <algorithm>
#include <stdexcept>

namespace orthant {
namespace {

template <class Space> using SceneIn = typename ElementsOf<Space>::Scene;

/// What a call by names stands for.
template <class Space> struct NamedIn {
  NamedIn(const SceneSource& source, SceneIn<Space> made, const std::vector<std::string>& of,
          const std::vector<std::string>& wrt, std::string_view integrator)
      : method(integrator.substr(0, integrator.find(':'))), scene(std::move(made)), system(scene) {
    if (method.size() < integrator.size()) given = integrator.substr(method.size() + 1);
    for (auto column = of.begin(); column != of.end(); ++column) {
      if (std::find(of.begin(), column, *column) != column)
        throw std::invalid_argument("column '" + in_one_line(*column) + "': is given twice: must be given once");
      columns.push_back(column_of(scene, *column));
    }
    for (auto key = wrt.begin(); key != wrt.end(); ++key) {
      if (std::find(wrt.begin(), key, *key) != key)
        throw std::invalid_argument("parameter '" + in_one_line(*key) + "': is given twice: must be given once");
      parameters.push_back(parameter_of(source, scene, *key));
    }
  }
  auto scheme(const char* others) const {
    std::conditional_t<kPlanar<Space>, StepScheme, std::variant<MoreauJeanOptions>> scheme;
    const auto refuse = [&](const std::string& rule) {
      throw std::invalid_argument("gradients: the integrator is '" + in_one_line(method) + "': must be moreau-jean" +
                                  rule);
    };
    if constexpr (kPlanar<Space>) {
      if (method == Rattle::kName)
        scheme = RattleOptions{};
      else if (method != MoreauJean::kName)
        refuse(std::string(" or rattle") + others);
    } else if (method != MoreauJean::kName) {
      refuse(", for scenes in space");
    }
    std::visit(
        [&](auto& options) {
          if (!given.empty()) set_options(options, given);
        },
        scheme);
    if constexpr (kPlanar<Space>)
      return scheme;
    else
      return std::get<MoreauJeanOptions>(scheme);
  }
  std::string method, given;
  SceneIn<Space> scene;
  SystemOf<Space> system;
  std::vector<RunColumn> columns;
  std::vector<RunParameterOf<Space>> parameters;
};
using Named = NamedIn<Planar>;

/// what(scene, its space) of a planar scene or one in space.
template <class What> auto in_its_space(const SceneSource& source, What&& what) {
  AnyScene made = source.make();
  if (auto* planar = std::get_if<Scene>(&made)) return what(std::move(*planar), Planar{});
  return what(std::get<spatial::Scene>(std::move(made)), Spatial{});
}

/// Of the motion itself.
GradientOfRun gradient_of_motion(const Named& named, Solver& solver, const Clock& clock) {
  const auto refuse = [](const std::string& what, const char* rule) {
    throw std::invalid_argument("gradients: by event-driven " + what + " has no derivatives: must be " + rule);
  };
  if (!named.scene.collisions.empty())
    refuse("the [[collision]] '" + named.scene.collisions.front().name + "'", "listed as [[contact]]");
  if (!named.scene.frictions.empty())
    refuse("the [[friction]] '" + named.scene.frictions.front().name + "'", "left out, or the integrator moreau-jean");
  if (named.scene.restitution != Restitution::newton) refuse("restitution = poisson", "newton");
  if (named.scene.impacts != Impacts::simultaneous) refuse("impacts = sequential", "simultaneous");
  EventDrivenOptions options;
  if (!named.given.empty()) set_options(options, named.given);
  ColumnSlopes slopes(named.system, named.columns);
  if (slopes.any_impulse())
    throw std::invalid_argument(
        "gradients: by event-driven impulses have none: must be columns of bodies, gaps, or the energy");
  std::vector<ParameterChange> changes;
  for (const RunParameter& parameter : named.parameters)
    changes.push_back(changes_of(parameter, named.system, clock.duration));
  GradientOfRun gradient;
  const MotionTangent motion = differentiate_motion(
      named.system, named.parameters, options, solver, clock.duration, clock.step * static_cast<double>(clock.every),
      [&](const State& x, const Eigen::MatrixXd& dq, const Eigen::MatrixXd& dv) {
        gradient.t.push_back(x.t);
        slopes.set_up(x);
        for (std::size_t i = 0; i < named.columns.size(); ++i) {
          gradient.value.push_back(slopes.value(i, x));
          for (std::size_t j = 0; j < changes.size(); ++j) {
            const auto column = static_cast<Index>(j);
            gradient.by.push_back(slopes.push(i, changes[j], dq.col(column).data(), dv.col(column).data()));
          }
        }
      },
      clock.cancel);
  if (!motion.none.empty()) throw std::runtime_error("gradients: the motion has no derivative: " + motion.none);
  gradient.tangent.run.status = motion.status, gradient.tangent.run.why = motion.why;
  gradient.tangent.run.final = motion.final;
  gradient.tangent.warnings = motion.warnings;
  gradient.tangent.q = motion.q, gradient.tangent.v = motion.v;
  return gradient;
}

}  // namespace

GradientOfRun gradient_of_run(const SceneSource& source, const std::vector<std::string>& of,
                              const std::vector<std::string>& wrt, std::string_view integrator, Solver& solver,
                              const Clock& clock) {
  check(clock);
  return in_its_space(source, [&]<class Space>(SceneIn<Space> scene, Space /*of it*/) {
    const NamedIn<Space> named(source, std::move(scene), of, wrt, integrator);
    if constexpr (kPlanar<Space>)
      if (named.method == EventDriven::kName) return gradient_of_motion(named, solver, clock);
    GradientOfRun gradient;
    gradient.tangent =
        differentiate_run(named.system, named.parameters, named.scheme(", or event-driven"), solver, clock,
                          named.columns, [&](double t, const Eigen::VectorXd& value, const Eigen::MatrixXd& by) {
                            gradient.t.push_back(t);
                            for (Index i = 0; i < value.size(); ++i) {
                              gradient.value.push_back(value[i]);
                              for (Index j = 0; j < by.cols(); ++j) gradient.by.push_back(by(i, j));
                            }
                          });
    return gradient;
  });
}

RunAdjoint adjoint_of_run(const SceneSource& source, const std::vector<std::string>& of,
                          const std::vector<std::string>& wrt, std::string_view integrator, Solver& solver,
                          const Clock& clock, Index scalars, const RecordWeights& weights) {
  return in_its_space(source, [&]<class Space>(SceneIn<Space> scene, Space /*of it*/) {
    const NamedIn<Space> named(source, std::move(scene), of, wrt, integrator);
    return differentiate_run_reverse(named.system, named.parameters, named.scheme(" in reverse mode"), solver, clock,
                                     named.columns, scalars, weights);
  });
}

Lyapunov lyapunov_of(const SceneSource& source, std::string_view integrator, Solver& solver, const LyapunovClock& clock,
                     const std::atomic<bool>* cancel) {
  AnyScene made = source.make();
  if (!std::holds_alternative<Scene>(made)) throw std::invalid_argument("lyapunov: the scene must be planar");
  const Named named(source, std::get<Scene>(std::move(made)), {}, {}, integrator);
  if (named.method != EventDriven::kName)
    throw std::invalid_argument("lyapunov: the integrator is '" + in_one_line(named.method) +
                                "': must be event-driven");
  EventDrivenOptions options;
  if (!named.given.empty()) set_options(options, named.given);
  Lyapunov found = lyapunov_exponents(named.system, options, solver, clock, cancel);
  if (!found.none.empty()) throw std::runtime_error("lyapunov: the motion has no tangents: " + found.none);
  return found;
}

}  // namespace orthant
