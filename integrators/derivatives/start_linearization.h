// integrators/derivatives/start_linearization.h — linearized start of a run: projected onto the joints.
//
//   q by (3) of projection_linearization.h from the given q, then v by (3) from that q on, as simulate() closes the
//   joints.
#pragma once

#include <orthant/integrators/derivatives/projection_linearization.h>

namespace orthant {

/// A parameter's part in the equations of a step or of the start, and in those of the projection behind it.
struct StepPart {
  SparsePart step, projection;
};

/// Σ part · adjoint.
inline double inner(const SparsePart& part, const Eigen::VectorXd& by) {
  double sum = 0;
  for (const auto& [place, value] : part) sum += value * by[place];
  return sum;
}
inline double inner(const StepPart& part, const Eigen::VectorXd& by_step, const Eigen::VectorXd& by_projection) {
  return inner(part.step, by_step) + inner(part.projection, by_projection);
}

class StartLinearization {
 public:
  explicit StartLinearization(const System& system) : places_(system), rates_(system) {
    unused_.setZero(system.dof());
  }

  /// From the state `given` to `closed`. Throws std::invalid_argument for a start that one projection does not close.
  void set_up(const State& given, const State& closed);

  void part_of(const ParameterChange& parameter, StepPart& part);
  void push(const StepPart& parameter, double* q, double* v);
  /// Calls parameter(adjoint of the coordinates' projection, of the velocities').
  template <class F> void pull(double* q, double* v, F&& parameter) {
    rates_.pull(q, v, by_rates_);
    unused_.setZero();
    places_.pull(q, unused_.data(), by_places_);
    parameter(by_places_, by_rates_);
  }

 private:
  ProjectionLinearization places_, rates_;
  Eigen::VectorXd unused_, by_places_, by_rates_;
};

}  // namespace orthant
