// core/mechanics/dynamics/each_joint.h — loop over the joints of a scene and their rows of G.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <variant>

namespace orthant {

template <class Joint> int rows_of_joint(const Joint& joint) {
  if constexpr (requires { joint.row_count(); })
    return joint.row_count();
  else
    return joint.kRows;
}

/// Calls what(joint, first row) over all joints, in the order of the scene.
template <class Space, class What> void each_joint(const SystemOf<Space>& system, What&& what) {
  int row = 0;
  for (const auto& joint : system.scene().joints)
    std::visit([&](const auto& j) { what(j, row), row += rows_of_joint(j); }, joint);
}

}  // namespace orthant
