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

template <class Space>
StepError error_of_step(const ParameterChangeOf<Space>& change, const SystemOf<Space>& system, double duration);

/// Whether at[0] and at[2] have the same values in all of that.
template <class Space> bool same_samples(const ParameterChangeOf<Space>& change, const SystemOf<Space>& system);

/// In space: the elements of `other` that differ from those of `system`, each in the order of ParameterChange's lists.
/// They are compared at the start and at another pose, at three times of the run.
void list_elements(const SystemOf<Spatial>& system, const SystemOf<Spatial>& other, double duration,
                   ParameterChangeOf<Spatial>& change);

/// The tensor of a body of another scene, in the axes that it has in `system`.
Eigen::Matrix3d tensor_in_axes(const SystemOf<Spatial>& system, const SystemOf<Spatial>& other, int body);
/// The initial state of another scene, its turns and angular velocities in the axes of `system`.
State start_in_axes(const SystemOf<Spatial>& system, const SystemOf<Spatial>& other);

}  // namespace orthant
