// integrators/derivatives/start_linearization.h — linearized start of a run: projected onto the joints.
//
//   q by (3) of projection_linearization.h from the given q, then v by (3) from that q on, as simulate() closes the
//   joints.
#pragma once

#include <orthant/integrators/derivatives/projection_linearization.h>
#include <orthant/integrators/derivatives/spatial_projection_linearization.h>

#include <type_traits>

namespace orthant {

template <class Space> class StartLinearizationOf {
 public:
  explicit StartLinearizationOf(const SystemOf<Space>& system) : places_(system), rates_(system) {
    unused_.setZero(system.dof());
  }

  /// From the state `given` to `closed`. Throws std::invalid_argument for a start that one projection does not close.
  void set_up(const State& given, const State& closed);

  void part_of(const ParameterChangeOf<Space>& parameter, StepPart& part);
  void push(const std::vector<StepPart>& parameters, DirectionBlock& q, DirectionBlock& v);
  /// Calls parameter(adjoint of the coordinates' projection, of the velocities').
  template <class F> void pull(double* q, double* v, F&& parameter) {
    rates_.pull(q, v, by_rates_);
    unused_.setZero();
    places_.pull(q, unused_.data(), by_places_);
    parameter(by_places_, by_rates_);
  }

 private:
  std::conditional_t<kPlanar<Space>, ProjectionLinearization, SpatialProjectionLinearization> places_, rates_;
  DirectionBlock unused_rates_;
  Eigen::VectorXd unused_, by_places_, by_rates_;
};
extern template class StartLinearizationOf<Planar>;
extern template class StartLinearizationOf<Spatial>;
using StartLinearization = StartLinearizationOf<Planar>;

}  // namespace orthant
