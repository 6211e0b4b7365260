// integrators/derivatives/parameter_step.h — error of differences by a parameter: truncation and rounding, estimated.
//
//   Of all that the parameter changes (rows and residuals of joints, gaps and rows of contacts, springs, dry friction,
//   loads, masses, the start), at the initial poses and at three times of the run.
//   D₄ = (4 D₂(ε) − D₂(2ε)) / 3 has an error of about the square of that of D₂(ε), relative to the largest derivative
//   of an element; rounding is 2⁻⁵² of its largest value over ε.
#pragma once

#include <orthant/integrators/derivatives/parameter_change.h>

namespace orthant {

struct StepError {
  double truncation = 0, rounding = 0;
  double sum() const { return truncation + rounding; }
};

StepError error_of_step(const ParameterChange& change, const System& system, double duration);

/// Whether at[0] and at[2] have the same values in all of that.
bool same_samples(const ParameterChange& change, const System& system);

}  // namespace orthant
