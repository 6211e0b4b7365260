// core/mechanics/scene/impact_law.h — impact laws of a scene, by name. Newton's restitution:
// integrators/step/rate_targets.h. Poisson's restitution and sequential impacts: integrators/step/impact.h.
#pragma once

#include <array>
#include <string_view>

namespace orthant {

enum class Restitution { newton, poisson };  // e relates velocities; e relates the impulses of two phases
inline constexpr std::array<std::string_view, 2> kRestitutionNames = {"newton", "poisson"};

enum class Impacts { simultaneous, sequential };  // all closed contacts at once; the fastest approach first, one by one
inline constexpr std::array<std::string_view, 2> kImpactsNames = {"simultaneous", "sequential"};

}  // namespace orthant
