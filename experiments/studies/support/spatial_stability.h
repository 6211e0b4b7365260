// experiments/studies/support/spatial_stability.h — numerical stability in space: scenes with exact motions, of which
// one number goes over its decades.
//
//   mass ratio         a ball of 1 kg is struck by one of `ratio` kg that spins: impact with slip, in closed form
//   load ratio         a ball of 1 kg on the floor carries one of `ratio` kg: nothing moves
//   needle             free body with the moments 1, 1, 1/ratio: Poinsot's motion
//   plate              free strip with the moments 1/ratio, 1, 1 + 1/ratio: its angular momentum is constant
//   spin               free body with the moments 1, 1, 1.7 at 1 … 1e6 rad/s, 0.02 rad a step: Poinsot's motion
//   turn per step      the same at 1000 rad/s, steps of 1e-4 … 10 rad
//   step               massé shot: slides on a parabola, then rolls (core/scenes/masse.h)
//   clearance          a ball in a socket swings as a pendulum of the length of the clearance, by 60°: one period
//   distance           the massé shot, up to 1000 km away
//   steps of a body    free asymmetric body, up to 10⁷ steps: its angular momentum is constant
//   steps of a pendulum  conical pendulum, likewise: its point stays on a circle
//   steps of a ball    elastic bouncing ball, likewise: its energy is constant
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/spatial/scene.h>

#include <functional>
#include <string>
#include <vector>

namespace orthant {

struct SpatialTrial {
  spatial::Scene scene;  // its step and duration are those of the run
  std::function<double(const SystemOf<Spatial>& system, const State& end)> error;  // against the exact answer
};

struct SpatialStudy {
  std::string name, unit;  // of the error: "m", "m/s"; "1": relative
  std::vector<double> values;
  std::function<SpatialTrial(double value)> trial;
  bool is_long() const { return name.starts_with("steps"); }
};

/// quick: every third decade, shorter runs.
std::vector<SpatialStudy> spatial_studies(bool quick);

struct SpatialTrialResult {
  std::string end, why;  // a status, or "refused"
  bool warned = false;   // the run says that its motion may be wrong, or warns otherwise
  double steps = 0, error = 0, residual = 0, drift = 0, penetration = 0, seconds = 0;
};

/// One trial by solver auto. error: at the end of the run, also where it failed. limit: of wall time [s].
SpatialTrialResult run_trial(const SpatialTrial& trial, const std::string& integrator, double limit);

}  // namespace orthant
