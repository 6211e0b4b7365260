// integrators/derivatives/parameter_scenes.h — scenes at other values of a parameter, by the step that resolves its
// change.
//
//   The choice that parameter_change.h describes: step, sides and weights of the differences.
#pragma once

#include <orthant/integrators/derivatives/parameter_change.h>

namespace orthant {

/// Scenes, step, sides, the lists of changed elements and the moved breakpoints of `change`. Throws
/// std::invalid_argument as changes_of().
template <class Space> void choose_scenes(const RunParameterOf<Space>& parameter, const SystemOf<Space>& system,
                                          double duration, double relative_step, ParameterChangeOf<Space>& change);

}  // namespace orthant
