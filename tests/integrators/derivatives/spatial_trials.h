// tests/integrators/derivatives/spatial_trials.h — derivatives of runs in space against central differences of runs.
#pragma once

#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/derivatives/run_adjoint.h>
#include <orthant/integrators/derivatives/run_tangent.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/integrators/derivatives/run_trials.h"

namespace orthant {

using SpatialParameter = RunParameterOf<Spatial>;

inline spatial::Scene spatial_from_text(const std::string& text, const std::vector<std::string>& sets = {}) {
  return std::get<spatial::Scene>(parse_any_scene(text, sets, "scene"));
}

/// A key with a number.
inline SpatialParameter by_key(const std::string& text, const std::string& key, double value) {
  return {key, value, [text, key](double x) { return spatial_from_text(text, {override_text(key, x)}); }, -1};
}
/// Any change of the scene; `at` is the value that the scene has.
template <class F> SpatialParameter by_change(const std::string& text, const std::string& name, double at, F change) {
  return {name, at,
          [=](double x) {
            spatial::Scene scene = spatial_from_text(text);
            change(scene, x);
            return scene;
          },
          -1};
}

/// A start entry, as the scene with it: of displacements, turns about the world's axes, velocities.
inline spatial::Scene with_start(const spatial::Scene& base, Index entry, double by) {
  spatial::Scene scene = base;
  const Index dof = Spatial::kVelocities * std::ssize(scene.bodies);
  const bool velocity = entry >= dof;
  const Index place = velocity ? entry - dof : entry;
  spatial::Body& body = scene.bodies[at(place / 6)];
  const Index axis = place % 3;
  if (place % 6 < 3)
    (velocity ? body.velocity : body.position)[axis] += by;
  else if (velocity)
    body.omega[axis] += by;
  else
    body.orientation =
        quaternions::product(quaternions::exponential(Vector3d(by * Vector3d::Unit(axis))), body.orientation);
  return scene;
}
inline SpatialParameter by_start(const spatial::Scene& base, Index entry) {
  return {"start " + std::to_string(entry), 0, [base, entry](double x) { return with_start(base, entry, x); }, entry};
}

/// All columns of the bodies.
inline std::vector<RunColumn> state_columns(const SystemOf<Spatial>& system) {
  std::vector<RunColumn> columns;
  for (Index i = 0; i < 13 * system.bodies(); ++i) columns.push_back({RunColumn::Kind::state, i});
  return columns;
}

struct SpatialTrial {
  double tolerance = 1e-6, step = 1e-6;  // of the largest derivative; of the value, or by itself
  bool scenes_of_start = false;          // start entries by scenes, not as entries
};

/// Every parameter's tangent at the end of the run, of state, energy and dry friction, against central differences of
/// runs.
inline RunTangent check_spatial(const spatial::Scene& base, std::vector<SpatialParameter> parameters,
                                const Clock& clock, const SpatialTrial& trial = {},
                                const MoreauJeanOptions& options = {}) {
  const SystemOf<Spatial> system(base);
  const auto solver = make_solver("auto");
  const auto columns = state_columns(system);
  auto asked_columns = columns;
  for (const RunColumn& column : energy_and_frictions(system)) asked_columns.push_back(column);
  std::vector<SpatialParameter> asked = parameters;
  for (SpatialParameter& p : asked) {
    if (p.start < 0) continue;
    if (trial.scenes_of_start)
      p.start = -1;
    else
      p.scene = {};
  }
  Clock ends = clock;
  ends.every = 1000000;
  Eigen::MatrixXd by;
  RunTangent tangent = differentiate_run(system, asked, options, *solver, ends, asked_columns,
                                         [&](double, const Eigen::VectorXd&, const Eigen::MatrixXd& x) { by = x; });
  REQUIRE(tangent.run.status == Status::solved);
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    INFO(parameters[j].name);
    const double value = parameters[j].value, step = trial.step * (value != 0 ? std::abs(value) : 1);
    Eigen::VectorXd end[2], others[2];
    State state;
    for (int k = 0; k < 2; ++k) {
      const SystemOf<Spatial> other(parameters[j].scene(value + (k == 0 ? -step : step)));
      MoreauJeanOf<Spatial> integrator(other, options);
      EnergyAndFrictions<Spatial> last(other);
      const Run run =
          simulate(integrator, *solver, ends, [&](const RunSampleOf<Spatial>& moment) { last.take(moment); });
      REQUIRE(run.status == Status::solved);
      others[k] = last.values, state = run.final;
      ColumnSlopesOf<Spatial> values(other, columns);
      end[k].resize(std::ssize(columns));
      for (std::size_t i = 0; i < columns.size(); ++i) end[k][static_cast<Index>(i)] = values.value(i, run.final);
    }
    const Eigen::VectorXd difference = (end[1] - end[0]) / (2 * step);
    const double most = difference.lpNorm<Eigen::Infinity>();
    const auto column = by.col(static_cast<Index>(j));
    const double off = (difference - column.head(difference.size())).lpNorm<Eigen::Infinity>();
    INFO("off by ", off / most, " of ", most);
    CHECK(off <= trial.tolerance * most);
    CHECK(most > 0);
    check_energy_and_frictions(system, state, Eigen::VectorXd(tangent.v.col(static_cast<Index>(j))),
                               column.tail(others[0].size()), (others[1] - others[0]) / (2 * step), trial.tolerance);
  }
  return tangent;
}

}  // namespace orthant
