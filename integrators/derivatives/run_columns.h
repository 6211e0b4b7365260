// integrators/derivatives/run_columns.h — columns of a run that have derivatives: state, gaps, energy, impulses.
#pragma once

#include <orthant/core/mechanics/spatial/friction_impulse.h>
#include <orthant/integrators/derivatives/rattle_linearization.h>
#include <orthant/integrators/derivatives/spatial_step_linearization.h>
#include <orthant/integrators/simulate.h>

#include <span>
#include <string>
#include <variant>
#include <vector>

namespace orthant {

/// Of the steps to differentiate: by moreau-jean, or by rattle.
using StepScheme = std::variant<MoreauJeanOptions, RattleOptions>;
template <class Options, class Space = Planar> struct StepSchemeOf;
template <> struct StepSchemeOf<MoreauJeanOptions> {
  using Integrator = MoreauJean;
  using Linearization = StepLinearization;
  /// In each step, of its length: where loads are evaluated, and where drives are.
  static std::vector<double> loads_at(const MoreauJeanOptions& options) { return {options.theta}; }
  static std::vector<double> drives_at(const MoreauJeanOptions& options) { return {options.theta, 1}; }
};
template <> struct StepSchemeOf<MoreauJeanOptions, Spatial> {
  using Integrator = MoreauJeanOf<Spatial>;
  using Linearization = SpatialStepLinearization;
  static std::vector<double> loads_at(const MoreauJeanOptions& options) { return {options.theta}; }
  static std::vector<double> drives_at(const MoreauJeanOptions& options) { return {options.theta, 1}; }
};
template <> struct StepSchemeOf<RattleOptions> {
  using Integrator = Rattle;
  using Linearization = RattleLinearization;
  static std::vector<double> loads_at(const RattleOptions& /*options*/) { return {1}; }
  static std::vector<double> drives_at(const RattleOptions& /*options*/) { return {1}; }
};

struct RunColumn {
  /// From `normal` on: impulses since the record before [N s], `friction` of a dry friction in a joint [N s, N m s].
  enum class Kind { state, gap, energy, normal, tangent, across, friction };
  Kind kind = Kind::state;
  /// In (q, v), 0 … 2 dof − 1; in space 13 of each body: x, y, z, the body's quaternion w, x, y, z, velocity and
  /// angular velocity in the world. Of gaps and impulses the contact or the friction; of the energy 0.
  Index place = 0;

  bool impulse() const { return kind >= Kind::normal; }
};

/// Steps of a run, as simulate() takes them; records stand at the start, every so many steps and at the end.
struct RunSteps {
  explicit RunSteps(const Clock& clock);
  double duration_of(long k) const { return k < whole ? step : rest; }
  double end_of(long k) const { return k + 1 < total ? static_cast<double>(k + 1) * step : duration; }
  bool recorded(long steps) const { return steps % every == 0 || steps == total; }
  long record_of(long steps) const { return steps == total ? records() - 1 : (steps + every - 1) / every; }
  long records() const { return 1 + (total + every - 1) / every; }
  double step, duration, rest;
  long whole, total, every;
};

/// Of a column of impulses: that of a step, and its change or weight.
template <class Space>
double impulse_of(RunColumn column, const SystemOf<Space>& system, const RunSampleOf<Space>& step) {
  if (column.kind == RunColumn::Kind::friction) return step.frictions[at(column.place)];
  const auto& one = step.impulses[at(column.place)];
  if (column.kind == RunColumn::Kind::normal) return one.normal;
  const auto tangent = along_unit_tangents(system.law(static_cast<int>(column.place)), one.tangent);
  return tangent_part(tangent, column.kind == RunColumn::Kind::across ? 1 : 0);
}
double& impulse_of(RunColumn column, ImpulseChange& change);

template <class Space> class ColumnSlopesOf {
 public:
  using System = SystemOf<Space>;
  using ParameterChange = ParameterChangeOf<Space>;

  /// Throws std::invalid_argument for places that are none.
  ColumnSlopesOf(const System& system, std::vector<RunColumn> columns);

  const std::vector<RunColumn>& columns() const { return columns_; }
  /// Whether a parameter may change a column of the same state.
  bool any_by_parameter() const { return any_gap_ || any_energy_; }
  bool any_impulse() const { return any_impulse_; }

  /// The state whose columns' slopes follow.
  void set_up(const State& x);
  /// Of column i: value, but of impulses 0.
  double value(std::size_t i, const State& x) const;
  /// Its change by (q̇, v̇) and the parameter; impulses none.
  double push(std::size_t i, const ParameterChange& parameter, const double* q, const double* v) const;
  /// Adds weight times its gradient.
  void pull(std::size_t i, double weight, double* q, double* v) const;
  double by_parameter(std::size_t i, const ParameterChange& parameter) const;

 private:
  const System& system_;
  std::vector<RunColumn> columns_;
  bool any_gap_ = false, any_impulse_ = false, any_energy_ = false;
  KinematicsOf<Space> at_;
  State x_;  // in the plane only for the energy
};
extern template class ColumnSlopesOf<Planar>;
extern template class ColumnSlopesOf<Spatial>;
using ColumnSlopes = ColumnSlopesOf<Planar>;

}  // namespace orthant
