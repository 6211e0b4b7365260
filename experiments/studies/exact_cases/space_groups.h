// experiments/studies/exact_cases/space_groups.h — groups of cases in space, and what they measure of a state.
#pragma once

#include "experiments/studies/exact_cases/exact_case.h"

#include <orthant/core/mechanics/dynamics/terms.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace orthant {

inline constexpr double kPi = std::numbers::pi;

inline Vector3d place(const State& x, Index body = 0) { return place_of<Spatial>(x.q, body); }
inline Vector3d velocity(const State& x, Index body = 0) { return translation<Spatial>(x.v, body); }

inline KinematicsOf<Spatial> poses(const SystemOf<Spatial>& system, const State& x) {
  KinematicsOf<Spatial> k;
  set_poses(system, x.t, x.q, k);
  set_twists(system, x.v, k);
  return k;
}

/// Angle of a revolute joint, in (−π, π].
inline double angle(const SystemOf<Spatial>& system, const State& x, std::size_t joint) {
  return std::get<spatial::Revolute>(system.scene().joints[joint]).angle().value(poses(system, x));
}

/// |a − b| up to whole turns.
inline double apart(double a, double b) { return std::abs(std::remainder(a - b, 2 * kPi)); }

/// Of the body's x and z axes, as columns of R.
inline double axes_error(const KinematicsOf<Spatial>& k, const Eigen::Matrix3d& R, BodyId body = 0) {
  return (k.at(body).turn(Vector3d::UnitX()) - R.col(0)).norm() +
         (k.at(body).turn(Vector3d::UnitZ()) - R.col(2)).norm();
}

inline Eigen::Vector4d quaternion_of(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).normalized();
}

void spinning_cases(std::vector<ExactCase>& all);          // S15, S16: free body, coins
void rolling_cases_in_space(std::vector<ExactCase>& all);  // S17, S18, S19: tippe-top, rattleback, ball in a cylinder
void wall_cases(std::vector<ExactCase>& all);              // S20, S21: dominoes, block on a moving wall
void rod_cases(std::vector<ExactCase>& all);               // S22, S23: Painlevé's rod, four-bar

}  // namespace orthant
