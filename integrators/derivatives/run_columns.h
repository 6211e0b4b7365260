// integrators/derivatives/run_columns.h — columns of a run that have derivatives: state, gaps, impulses of contacts.
#pragma once

#include <orthant/integrators/derivatives/rattle_linearization.h>
#include <orthant/integrators/simulate.h>

#include <span>
#include <variant>
#include <vector>

namespace orthant {

/// Of the steps to differentiate: by moreau-jean, or by rattle.
using StepScheme = std::variant<MoreauJeanOptions, RattleOptions>;
template <class Options> struct StepSchemeOf;
template <> struct StepSchemeOf<MoreauJeanOptions> {
  using Integrator = MoreauJean;
  using Linearization = StepLinearization;
};
template <> struct StepSchemeOf<RattleOptions> {
  using Integrator = Rattle;
  using Linearization = RattleLinearization;
};

struct RunColumn {
  enum class Kind { state, gap, normal, tangent };  // the last two: impulses since the record before [N s]
  Kind kind = Kind::state;
  Index place = 0;  // in (q, v), 0 … 2 dof − 1; of the others the contact
};

/// A step in which rows are weakly active: only one-sided derivatives exist from here on.
struct DegenerateStep {
  double t = 0;               // [s] its begin
  std::vector<int> contacts;  // of the scene
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

class ColumnSlopes {
 public:
  /// Throws std::invalid_argument for places that are none.
  ColumnSlopes(const System& system, std::vector<RunColumn> columns);

  const std::vector<RunColumn>& columns() const { return columns_; }
  bool any_gap() const { return any_gap_; }
  bool any_impulse() const { return any_impulse_; }

  /// Poses for the gaps' slopes.
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
  bool any_gap_ = false, any_impulse_ = false;
  Kinematics at_;
};

}  // namespace orthant
