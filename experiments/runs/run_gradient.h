// experiments/runs/run_gradient.h — gradient of a run's columns by names: of "crank.theta" by "mu", "body.rod.mass".
#pragma once

#include "experiments/runs/run_names.h"

#include <orthant/integrators/derivatives/lyapunov.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/run_adjoint.h>
#include <orthant/integrators/derivatives/run_tangent.h>

#include <string>
#include <string_view>
#include <vector>

namespace orthant {

struct GradientOfRun {
  RunTangent tangent;
  std::vector<double> t;      // of the rows
  std::vector<double> value;  // rows × columns
  std::vector<double> by;     // rows × columns × parameters
};

/// Forward mode. `of`: columns as above; integrator: "moreau-jean[:theta=…]"; in the plane also "rattle", or
/// "event-driven": of the motion itself (motion_tangent.h), where a row stands every so many times clock.step. The
/// first row and the last always.
GradientOfRun gradient_of_run(const SceneSource& source, const std::vector<std::string>& of,
                              const std::vector<std::string>& wrt, std::string_view integrator, Solver& solver,
                              const Clock& clock);

/// Reverse mode, of scalars that are weighted sums over the rows and columns.
RunAdjoint adjoint_of_run(const SceneSource& source, const std::vector<std::string>& of,
                          const std::vector<std::string>& wrt, std::string_view integrator, Solver& solver,
                          const Clock& clock, Index scalars, const RecordWeights& weights);

/// Lyapunov exponents of the motion; integrator: "event-driven[:option=value,…]". Throws std::runtime_error where the
/// motion has no tangents (a graze, a crowd of events).
Lyapunov lyapunov_of(const SceneSource& source, std::string_view integrator, Solver& solver, const LyapunovClock& clock,
                     const std::atomic<bool>* cancel);

}  // namespace orthant
