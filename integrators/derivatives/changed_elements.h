// integrators/derivatives/changed_elements.h — elements of two scenes that differ.
//
//   Elements differ where their rows, residuals or forces may: planar ones by their data, those in space by samples
//   (parameter_step.h). Contact laws do not count. Elements that cannot be compared (polygons, custom ones, tables)
//   differ.
#pragma once

#include <orthant/integrators/derivatives/parameter_change.h>

namespace orthant {

/// The lists of `change`, and whether the times of a drive's table differ. duration: of the run [s]. Throws
/// std::invalid_argument where the scenes have other numbers of elements.
template <class Space> void list_changed_elements(const SystemOf<Space>& system, const SystemOf<Space>& changed,
                                                  double duration, ParameterChangeOf<Space>& change);

}  // namespace orthant
