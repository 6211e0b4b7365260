#include <orthant/integrators/step/gyroscopic.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant {
namespace {

/// exp φ as a rotation, both ways.
class Turn {
 public:
  explicit Turn(const Vector3d& phi) : p_(quaternions::exponential(phi)) {}
  Vector3d forward(const Vector3d& x) const { return turned(p_.tail<3>(), x); }
  Vector3d back(const Vector3d& x) const { return turned(-p_.tail<3>(), x); }

 private:
  Vector3d turned(const Vector3d& u, const Vector3d& x) const {
    const Vector3d across = 2 * u.cross(x);
    return x + p_[0] * across + u.cross(across);
  }
  Eigen::Vector4d p_;
};

struct AtEnd {
  Vector3d omega;  // ω⁺
  Turn step;       // exp(h ω_m)
};

/// exp(a h ω), from the start's axes to the frame's.
Turn to_start(const StepFrames& frames, const Vector3d& omega) { return Turn(frames.at * frames.h * omega); }

/// ω⁺ = exp(−h ω_m) exp(a h ω) w, by repetition.
AtEnd at_end(const StepFrames& frames, const Vector3d& omega, const Turn& start, const Vector3d& w) {
  constexpr int kPasses = 60;
  const Vector3d in_start = start.forward(w);
  // Each pass shrinks the change at least by h θ |w|: it ends where the next change is below rounding.
  const double speed = w.norm(), shrinks = std::min(1.0, frames.h * frames.theta * speed);
  const double enough = 1e-16 * (speed + omega.norm());
  AtEnd end{w, Turn(Vector3d::Zero())};
  for (int pass = 0; pass < kPasses; ++pass) {
    end.step = Turn(frames.h * ((1 - frames.theta) * omega + frames.theta * end.omega));
    const Vector3d next = end.step.back(in_start);
    const double change = (next - end.omega).norm();
    end.omega = next;
    if (shrinks * change <= enough) break;
  }
  return end;
}

}  // namespace

void gyroscopic_impulse(const SystemOf<Spatial>& system, const StepFrames& frames, const Eigen::VectorXd& v,
                        const Eigen::VectorXd& w, Eigen::VectorXd& g) {
  for (Eigen::Index i = 0; i < system.bodies(); ++i) {
    const Vector3d J = rotation<Spatial>(system.mass(), i);
    if (J[0] == J[1] && J[1] == J[2]) {
      rotation<Spatial>(g, i).setZero();
      continue;
    }
    const Vector3d omega = rotation<Spatial>(v, i), after = rotation<Spatial>(w, i);
    const Turn start = to_start(frames, omega);
    const AtEnd end = at_end(frames, omega, start, after);
    const Vector3d momentum = start.back(end.step.forward(J.cwiseProduct(end.omega)));
    rotation<Spatial>(g, i) =
        J.cwiseProduct(after) - momentum - J.cwiseProduct(omega) + start.back(J.cwiseProduct(omega));
  }
}

bool half_turning_impulse(const SystemOf<Spatial>& system, double h, const Eigen::VectorXd& u, Half half,
                          Eigen::VectorXd& g) {
  bool fits = true;
  for (Eigen::Index i = 0; i < system.bodies(); ++i) {
    const Vector3d J = rotation<Spatial>(system.mass(), i), xi = h * rotation<Spatial>(u, i);
    if (J[0] == J[1] && J[1] == J[2]) {
      rotation<Spatial>(g, i).setZero();
      continue;
    }
    const Vector3d momentum = J.cwiseProduct(rotation<Spatial>(u, i));
    const double square = xi.squaredNorm(), angle = std::sqrt(square);
    // Below 1e-2 the next term of the series is below 1e-16 of it.
    const double c = square < 1e-4 ? 1.0 / 12 + square / 720 + square * square / 30240
                                   : (1 - angle / 2 / std::tan(angle / 2)) / square;
    const Vector3d across = xi.cross(momentum), twice = c * xi.cross(across);
    rotation<Spatial>(g, i) = -across / 2 + (half == Half::first ? -twice : twice);
    fits = fits && angle < 2 * std::numbers::pi;
  }
  return fits;
}

void to_end_axes(const SystemOf<Spatial>& system, const StepFrames& frames, const Eigen::VectorXd& v,
                 Eigen::VectorXd& w) {
  for (Eigen::Index i = 0; i < system.bodies(); ++i) {
    const Vector3d omega = rotation<Spatial>(v, i), after = rotation<Spatial>(w, i);
    rotation<Spatial>(w, i) = at_end(frames, omega, to_start(frames, omega), after).omega;
  }
}

}  // namespace orthant
