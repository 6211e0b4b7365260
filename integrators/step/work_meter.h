// integrators/step/work_meter.h — work of drives, loads and moving surfaces: the external terms of the energy balance.
//
//   Step from (t₀, q₀, v₀) to (t₁, q₁, v₁) with known contact impulses, evaluated at the midpoint:
//     M (v₁ − v₀) − h f − W_Nᵀ Λ_N − W_Tᵀ Λ_T = Gᵀ Λ_G in the least-squares sense of M⁻¹;   drives: Σ Λ_i ṡ_i
//     loads: F · (P₁ − P₀) + τ (θ₁ − θ₀), times the factor by Simpson's rule;   surfaces: Σ Λ_T belt
//   Its error is of second order on smooth motion, of first order in steps with impacts.
//   Smooth motion: the power Σ λ_i ṡ_i + F · Ṗ + λ_T belt at three Gauss points of an interval, at positions of Hermite
//   polynomials.   Impacts: v̄ · M (v⁺ − v⁻) − Σ Λ γ̄ with the mean velocities, which is Σ Λ_i ṡ_i of the drives.
// Cost: nothing if a scene has none of these; else one factorization per step, three per interval.
#pragma once

#include <orthant/integrators/between_events/contact_watch.h>

#include <memory>

namespace orthant {

class WorkMeter {
 public:
  explicit WorkMeter(const System& system);

  /// True: the scene has a drive, load or moving surface that can do work.
  static bool needed(const System& system);

  /// [J] of a whole step; impulses, frictions and pairs as the integrator reports them.
  double over_step(const State& from, const State& to, const std::vector<Impulse>& impulses,
                   const std::vector<double>& frictions, std::span<const Pair> pairs);

  /// [J] of the smooth motion of length s [s] from a, at the time t, to b, in these modes.
  double over_motion(double t, double s, const MotionPoint& a, const MotionPoint& b,
                     const std::vector<ContactMode>& modes);

  /// The same between two states, whose accelerations it evaluates.
  double over_motion(const State& from, const State& to, const std::vector<ContactMode>& modes);

  /// [J] of an instant: the velocity jumps from `before` to `after` by these impulses at the contacts terms.closed.
  double over_impact(const Terms& terms, const Eigen::VectorXd& before, const Eigen::VectorXd& after,
                     const std::vector<Impulse>& impulses) const;

  /// Makes the next result independent of earlier matrices (BasicSystem::forget).
  void forget();

 private:
  double power(double t, const MotionPoint& p);
  double of_loads(const State& from, const State& to);

  const System& system_;
  Terms terms_;
  BasicSystem basic_;
  std::unique_ptr<ContactMotion> motion_;  // of over_motion()
  MotionPoint point_, from_, to_point_;
  Kinematics to_;
  Eigen::VectorXd middle_, force_, mean_, lambda_, rate_, none_;
};

}  // namespace orthant
