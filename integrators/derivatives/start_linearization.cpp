#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/start_linearization.h>

#include <algorithm>
#include <stdexcept>

namespace orthant {

template <class Space> void StartLinearizationOf<Space>::set_up(const State& given, const State& closed) {
  constexpr double kSame = 1e-8;  // of the state: what one projection leaves
  State between = closed;
  between.v = given.v;
  const double missed =
      std::max(places_.set_up(closed.t, given.q, given.v, between), rates_.set_up(closed.t, closed.q, given.v, closed));
  if (!(missed <= kSame))
    throw std::invalid_argument("derivatives of a run: the start breaks the joints, by " + detail::text_of(missed) +
                                " more than one projection closes: must keep them");
}

template <class Space>
void StartLinearizationOf<Space>::part_of(const ParameterChangeOf<Space>& parameter, StepPart& part) {
  part.step.clear(), part.projection.clear();
  if (!parameter.of_scene()) return;
  rates_.part_of(parameter, part.projection);
  places_.part_of(parameter, part.step);
}

template <class Space>
void StartLinearizationOf<Space>::push(const std::vector<StepPart>& parameters, DirectionBlock& q, DirectionBlock& v) {
  unused_rates_.setZero(v.rows(), v.cols());  // the velocities are those of the second projection
  places_.push({&parameters, &StepPart::step}, q, unused_rates_);
  rates_.push({&parameters, &StepPart::projection}, q, v);
}

template class StartLinearizationOf<Planar>;
template class StartLinearizationOf<Spatial>;

}  // namespace orthant
