// core/mechanics/planar/custom_check.h — check of a user-defined joint or contact by itself, at the start of a scene.
#pragma once

#include <orthant/core/mechanics/planar/geometry.h>

#include <optional>
#include <string>

namespace orthant {

/// What a kind with a function `std::string wrong(const Kinematics& start) const` finds wrong, in words; empty words:
/// nothing. Kinds without it give no answer: check(scene) compares their derivatives with differences (derivatives.h).
template <class T> std::optional<std::string> own_check(const T& kind, const Kinematics& start) {
  if constexpr (requires { kind.wrong(start); })
    return kind.wrong(start);
  else
    return {};
}

}  // namespace orthant
