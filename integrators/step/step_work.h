// integrators/step/step_work.h — work of drives, loads and moving surfaces over a step of a fixed-step scheme.
//
//   Step from (t₀, q₀, v₀) to (t₁, q₁, v₁) with known contact impulses, evaluated at the midpoint:
//     M (v₁ − v₀) − h f − W_Nᵀ Λ_N − W_Tᵀ Λ_T = Gᵀ Λ_G in the least-squares sense of M⁻¹;   drives: Σ Λ_i ṡ_i
//     loads in the plane: F · (P₁ − P₀) + τ (θ₁ − θ₀), times the factor by Simpson's rule; in space: h times the power
//     at the midpoint;   surfaces: Σ Λ_T belt
//   Its error is of second order on smooth motion, of first order in steps with impacts.
// Cost: nothing if a scene has none of these; else one factorization per step.
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/integrator.h>

namespace orthant {

/// True: the scene has a drive, load or moving surface that can do work.
template <class Space> bool has_work(const SystemOf<Space>& system);

template <class Space> class StepWorkOf {
 public:
  explicit StepWorkOf(const SystemOf<Space>& system);

  /// [J] of a whole step; impulses, frictions and pairs as the integrator reports them.
  double over_step(const State& from, const State& to, const std::vector<ImpulseOf<Space>>& impulses,
                   const std::vector<double>& frictions, std::span<const Pair> pairs);

  /// Makes the next result independent of earlier matrices (BasicSystem::forget).
  void forget() { basic_.forget(); }

 private:
  double of_loads(const State& from, const State& to);
  void set_middle(const State& from, const State& to);

  const SystemOf<Space>& system_;
  TermsOf<Space> terms_;
  BasicSystemOf<Space> basic_;
  KinematicsOf<Space> to_;
  Eigen::VectorXd middle_, force_, mean_, lambda_, rate_, none_;
  bool has_belts_;  // in space
};

/// [J] by which energy rises in a step of first order across a crowd of events, beyond this work; 0 where that is
/// rounding.
template <class Space>
double gain_of_crossing(const SystemOf<Space>& system, const State& from, const State& to, double work);

template <> double StepWorkOf<Planar>::of_loads(const State& from, const State& to);
template <> double StepWorkOf<Spatial>::of_loads(const State& from, const State& to);
extern template class StepWorkOf<Planar>;
extern template class StepWorkOf<Spatial>;

}  // namespace orthant
