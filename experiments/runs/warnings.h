// experiments/runs/warnings.h — warnings about a run: its start, its course, limits of the numbers that it enters
// (docs/theory/accuracy.md measures those). `orthant simulate` prints them, Python warns of them.
#pragma once

#include <orthant/integrators/simulate.h>

#include <string>
#include <string_view>
#include <vector>

namespace orthant {

inline constexpr double kMassRatio = 1e9;  // of bodies that may act on one another
inline constexpr double kSwing = 1;        // [rad] ω h of a spring
inline constexpr double kTurn = 0.5;       // [rad] that a body turns in a step
inline constexpr double kMisturned = 0.1;  // [rad] error of free rotation
inline constexpr double kDamped = 100;     // h c / m of a damper
inline constexpr double kFar = 1e5;        // [m] from the origin, [rad]: places and angles are rounded to 1e-11

struct Remark {
  bool warning = true;  // false: a note
  std::string words;
};

/// Of the start: it breaks joints, contacts penetrate; a note names redundant joints, or what an import left out.
std::vector<Remark> remarks_on_start(const System& system);
std::vector<Remark> remarks_on_start(const SystemOf<Spatial>& system);

/// All warnings of a run that has ended, limits_entered() among them.
template <class Space> std::vector<std::string> warnings_of(const SystemOf<Space>& system, const Run& run,
                                                            std::string_view integrator, double step);

/// In words, each limit that the run has entered; of schemes that choose their steps the step counts for nothing.
template <class Space> std::vector<std::string> limits_entered(const SystemOf<Space>& system, const Run& run,
                                                               std::string_view integrator, double step);

}  // namespace orthant
