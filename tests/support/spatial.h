// tests/support/spatial.h — runs of scenes in space, and what is measured of them.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

namespace orthant {

using SpatialSystem = SystemOf<Spatial>;
using SpatialSample = RunSampleOf<Spatial>;

/// Turns about its middle axis, which is unstable: it tumbles. The tensor is not diagonal in the body's frame.
inline spatial::Scene tumbling() {
  const Eigen::Matrix3d R = quaternions::matrix_of(quaternions::exponential(Eigen::Vector3d(0.4, -0.3, 0.9)));
  spatial::Scene s;
  s.body({.name = "book",
          .mass = 2,
          .inertia = R * Eigen::Vector3d(1, 2, 3).asDiagonal() * R.transpose(),
          .position = {1, 2, 3},
          .velocity = {0.3, -0.2, 0.1},
          .omega = R * Eigen::Vector3d(0.05, 4, 0.1)});
  return s;
}

/// One run by solver auto; must end as solved.
inline Run run_in_space(const SpatialSystem& system, std::string_view integrator, double step, double duration,
                        const RecorderOf<Spatial>& record = {}) {
  const auto scheme = make_integrator(integrator, system);
  const auto solver = make_solver("auto");
  Run run = simulate(*scheme, *solver, {.step = step, .duration = duration}, record);
  INFO(integrator << " at h = " << step << ": " << run.why);
  REQUIRE(run.status == Status::solved);
  return run;
}

inline KinematicsOf<Spatial> poses_of(const SpatialSystem& system, const State& x) {
  KinematicsOf<Spatial> k;
  set_poses(system, x.t, x.q, k);
  set_twists(system, x.v, k);
  return k;
}

/// Angular momentum of all bodies about the origin of the world [kg m²/s].
inline Vector3d angular_momentum(const SpatialSystem& system, const State& x) {
  const KinematicsOf<Spatial> k = poses_of(system, x);
  Vector3d sum(0, 0, 0);
  for (int i = 0; i < system.bodies(); ++i) {
    const Vector3d J = rotation<Spatial>(system.mass(), i), omega = rotation<Spatial>(x.v, i);
    sum += k.at(i).axes * J.cwiseProduct(omega) + system.mass()[6 * i] * k.at(i).x.cross(k.rate(i).v);
  }
  return sum;
}

/// Angular velocity of a body in the world [rad/s].
inline Vector3d world_omega(const SpatialSystem& system, const State& x, BodyId body) {
  return poses_of(system, x).rate(body).omega;
}

}  // namespace orthant
