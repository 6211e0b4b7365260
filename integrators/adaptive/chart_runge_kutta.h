// integrators/adaptive/chart_runge_kutta.h — Runge–Kutta method of order 8 (Dormand & Prince) in charts of the
// rotations.
//
//   Within a step from (q, v) the coordinates are q exp φ (move(), blocks.h), and the method is applied to (φ, v):
//     φ' = v of translations,  φ' = J⁻¹(φ) ω of rotations,  v' = a(t, q exp φ, v),  φ = 0 at first,
//     J⁻¹(φ) ω = ω + ½ φ × ω + c φ × (φ × ω),   c = 1/|φ|² − (1 + cos |φ|) / (2 |φ| sin |φ|),
//   ω in the body's axes. The chart is new in each step: quaternions keep their length, and φ stays far from 2π.
//   Differences to the first stage are summed, not the stages: rounding is small where the step is.
//   Error estimate: that of dormand_prince.h, which has the coefficients.
// Source: Munthe-Kaas, Applied Numerical Mathematics 29 (1999) 115-127; Solà, Deray & Atchuthan, A micro Lie theory for
// state estimation in robotics (2018), eq. 144; Hairer, Nørsett & Wanner (1993), II.5, II.10.
#pragma once

#include <orthant/core/mechanics/blocks.h>
#include <orthant/integrators/event_driven/dormand_prince.h>

namespace orthant {

class ChartRungeKutta {
 public:
  static constexpr double kErrorOrder = DormandPrince::kErrorOrder;

  explicit ChartRungeKutta(Eigen::Index dof)
      : d_path_(dof, dormand_prince::kStages),
        d_v_(dof, dormand_prince::kStages),
        path_(dof),
        rate_(dof),
        v_(dof),
        a_(dof),
        sum_(dof) {}

  /// J⁻¹(φ) ω.
  static Vector3d rotation_rate(const Vector3d& phi, const Vector3d& omega) {
    const double square = phi.squaredNorm(), angle = std::sqrt(square);
    const double c = square < 1e-4 ? 1.0 / 12 + square / 720 + square * square / 30240
                                   : 1 / square - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
    const Vector3d across = phi.cross(omega);
    return omega + across / 2 + c * phi.cross(across);
  }
  /// φ' of all bodies.
  static void rate(const Eigen::VectorXd& path, const Eigen::VectorXd& v, Eigen::VectorXd& to) {
    to = v;
    for (Eigen::Index i = 0; i < v.size() / Spatial::kVelocities; ++i)
      rotation<Spatial>(to, i) = rotation_rate(rotation<Spatial>(path, i), rotation<Spatial>(v, i));
  }

  /// As DormandPrince::step(); q has a spatial block per body, v, `first` and the result of acceleration() too.
  template <class Acceleration, class Seen> bool step(Acceleration&& acceleration, double t, const Eigen::VectorXd& q,
                                                      const Eigen::VectorXd& v, const Eigen::VectorXd& first, double h,
                                                      Eigen::VectorXd& q_next, Eigen::VectorXd& v_next, Seen&& seen) {
    using namespace dormand_prince;
    const auto reach = [&](double c, const Stages& weights, std::size_t stages, Eigen::VectorXd& v_new) {
      combine(d_path_, weights, stages);
      path_ = h * (c * v + sum_);
      combine(d_v_, weights, stages);
      v_new = v + h * (c * first + sum_);
    };
    for (std::size_t i = 1; i < kStages; ++i) {
      reach(kC[i], kA[i], i, v_);
      move<Spatial>(q, path_, q_);
      if (!acceleration(t + kC[i] * h, q_, v_, a_)) return false;
      rate(path_, v_, rate_);
      d_path_.col(static_cast<Eigen::Index>(i)) = rate_ - v;
      d_v_.col(static_cast<Eigen::Index>(i)) = a_ - first;
      seen(kB[i]);
    }
    reach(1, kB, kStages, v_next);
    move<Spatial>(q, path_, q_next);
    return path_.allFinite() && v_next.allFinite();
  }

  /// Of the last step, each entry over its scale; accepted when ≤ 1.
  double error(double h, const Eigen::VectorXd& path_scale, const Eigen::VectorXd& v_scale) {
    using namespace dormand_prince;
    const auto square = [&](const Stages& weights) {
      combine(d_path_, weights, kStages);
      const double in_path = sum_.cwiseQuotient(path_scale).squaredNorm();
      combine(d_v_, weights, kStages);
      return in_path + sum_.cwiseQuotient(v_scale).squaredNorm();
    };
    const double fifth = square(kE), third = square(kE3);
    if (fifth == 0) return 0;
    return std::abs(h) * fifth / std::sqrt((fifth + 0.01 * third) * 2 * static_cast<double>(path_scale.size()));
  }

  /// φ at the end of the last step.
  const Eigen::VectorXd& path() const { return path_; }

 private:
  using Stages = dormand_prince::Stages;

  void combine(const Eigen::MatrixXd& d, const Stages& weights, std::size_t stages) {
    sum_.setZero();
    for (std::size_t i = 1; i < stages; ++i)
      if (weights[i] != 0) sum_ += weights[i] * d.col(static_cast<Eigen::Index>(i));
  }

  Eigen::MatrixXd d_path_, d_v_;  // of each stage, less those of the first
  Eigen::VectorXd path_, rate_, v_, a_, sum_, q_;
};

}  // namespace orthant
