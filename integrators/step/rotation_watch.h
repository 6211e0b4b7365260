// integrators/step/rotation_watch.h — error of free rotation in space, estimated over a run of fixed steps.
//
//   In a step without torque Euler's equation is J ω̇ = Jω × ω. A scheme turns a body by exp(h u), in its own axes, and
//   takes ω to ω⁺. With ω̄ = (ω + ω⁺)/2 it adds
//     δ = ω⁺ − ω + h J⁻¹ (ω̄ × Jω̄)   to the error S of the velocity,                                            (1)
//     h (u − ω̄ + S + δ/2)           to the error D of the orientation [rad].                                   (2)
//   Both of a step are O(h³) for schemes of order 2. Sums are signed: errors that swing cancel. |D| is the estimate. It
//   leaves out that the motion may magnify errors. Slender bodies have the largest: a tilt of the axes by ε changes the
//   spin of a needle by ε L / J_3.
//   A step that changes the angular momentum, by contacts, joints, loads, is left out; S begins again after it. So are
//   most steps of generalized-alpha, which keeps the momentum to O(h³) only: it has no estimate, and needs none.
// Cost: two quaternions and a dozen cross products a step of each body with different moments; nothing for spheres.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/integrators/checkpoint.h>

#include <vector>

namespace orthant {

class RotationWatch {
 public:
  RotationWatch(const SystemOf<Spatial>& system, const State& start);

  /// The next state, after a step of h [s].
  void follow(double h, const State& x);

  double error() const { return error_; }  // [rad] the largest |D| so far
  BodyId body() const { return body_; }    // that has it
  void remember(CheckpointData& memory);

 private:
  struct Rotation {
    Eigen::Index body = 0;
    Eigen::Vector4d p;         // orientation
    Vector3d omega, momentum;  // in the body's axes [rad/s]; in the world [N m s]
    Vector3d S = Vector3d::Zero(), D = Vector3d::Zero();
  };

  const SystemOf<Spatial>& system_;
  std::vector<Rotation> rotations_;  // of bodies with different moments
  double error_ = 0;
  BodyId body_ = kGround;
};

}  // namespace orthant
