#include <orthant/integrators/step/rotation_watch.h>

namespace orthant {
namespace {

constexpr double kNoTorque = 1e-6;  // of the angular momentum, its change in a step: schemes keep it to 1e-12

}  // namespace

RotationWatch::RotationWatch(const SystemOf<Spatial>& system, const State& start) : system_(system) {
  for (Eigen::Index i = 0; i < system.bodies(); ++i) {
    const Vector3d J = rotation<Spatial>(system.mass(), i);
    if (J[0] == J[1] && J[1] == J[2]) continue;
    Rotation one;
    one.body = i, one.p = quaternion(start.q, i), one.omega = rotation<Spatial>(start.v, i);
    one.momentum = quaternions::matrix_of(one.p) * J.cwiseProduct(one.omega);
    rotations_.push_back(one);
  }
}

void RotationWatch::follow(double h, const State& x) {
  for (Rotation& one : rotations_) {
    const Vector3d J = rotation<Spatial>(system_.mass(), one.body), omega = rotation<Spatial>(x.v, one.body);
    const Eigen::Vector4d p = quaternion(x.q, one.body);
    const Vector3d momentum = quaternions::matrix_of(p) * J.cwiseProduct(omega);
    if ((momentum - one.momentum).squaredNorm() <= kNoTorque * kNoTorque * momentum.squaredNorm()) {
      const Vector3d turn = quaternions::turn_between(one.p, p), mean = (one.omega + omega) / 2;
      const Vector3d delta = omega - one.omega + h * mean.cross(J.cwiseProduct(mean)).cwiseQuotient(J);
      one.D += turn + h * (one.S + delta / 2 - mean), one.S += delta;
      if (const double error = one.D.norm(); error > error_) error_ = error, body_ = static_cast<BodyId>(one.body);
    } else {
      one.S.setZero();
    }
    one.p = p, one.omega = omega, one.momentum = momentum;
  }
}

void RotationWatch::remember(CheckpointData& memory) {
  memory(error_, body_);
  for (Rotation& one : rotations_)
    for (Eigen::Index k = 0; k < 4; ++k) {
      memory(one.p[k]);
      if (k < 3) memory(one.omega[k], one.momentum[k], one.S[k], one.D[k]);
    }
}

}  // namespace orthant
