// tests/support/runs.h — runs of scenes in one call.
#pragma once

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <cmath>
#include <string_view>

namespace orthant {

inline Run run(const Scene& scene, std::string_view integrator, double h, const Recorder& record = {},
               std::string_view solver = "lemke") {
  const System system(scene);
  const auto scheme = make_integrator(integrator, system);
  const auto lcp = make_solver(solver);
  return simulate(*scheme, *lcp, {.step = h, .duration = scene.duration, .every = 1}, record);
}

inline Run run_for(Scene scene, double duration, std::string_view integrator, double h, const Recorder& record = {}) {
  scene.duration = duration;
  return run(scene, integrator, h, record);
}

inline constexpr std::string_view kPosition = "moreau-jean:joints=position";
inline constexpr std::string_view kSymmetric = "moreau-jean:joints=symmetric";
inline constexpr Eigen::Index kTheta1 = 2, kTheta3 = 8;

inline double theta1_error(const SliderCrankExact& exact, std::string_view integrator, double h) {
  const Run r = run(slider_crank({.mu = exact.mu, .e = exact.e}), integrator, h);
  REQUIRE(r.status == Status::solved);
  return std::abs(r.final.q[kTheta1] - exact.theta1);
}

}  // namespace orthant
