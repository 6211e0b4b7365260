// integrators/derivatives/lyapunov.h — Lyapunov exponents of a motion with impacts and friction, from its tangents.
//
//   λ_i = lim (1/t) ln |δ_i(t)|, δ_1 … δ_k the tangents of motion_tangent.h, made orthonormal every `every` seconds:
//     (δ_1 … δ_k) = Q R,   λ_i ≈ (1/T) Σ ln R_ii over the T seconds after the transient,   δ_i ← column i of Q
//   The norm is that of (q̇, v̇) in SI units; λ does not depend on it. There are at most 2 (dof − rank of G) exponents.
//   A direction that a lasting contact or a plastic impact takes away has the exponent −∞: its column shrinks by more
//   than 1e-11 in `every`, where the differences that make the tangents end.
//   The sum over all directions is the mean rate at which volumes of (q, v) change: 2 ln e for a frictionless impact.
//   Steps are those of the motion, whatever its tangents do; `every` bounds them. Cost: 4 k evaluations of each step.
//   Grazes and crowds of events have no tangent (`none` of the result).
//   Source: Benettin, Galgani, Giorgilli & Strelcyn, Meccanica 15 (1980) 9-30; Müller, Chaos, Solitons & Fractals 5
//   (1995) 1671-1681 (nonsmooth motions).
#pragma once

#include <orthant/integrators/derivatives/motion_tangent.h>

namespace orthant {

struct LyapunovClock {
  int count = 1;         // exponents, the largest first
  double duration = 10;  // [s] after the transient
  double transient = 0;  // [s] before it: tangents turn towards the directions that grow most
  double every = 0.1;    // [s] between two orthonormalizations
};

struct Lyapunov {
  Status status = Status::solved;
  std::string why;
  State final;
  Eigen::VectorXd exponents;  // [1/s]
  Eigen::VectorXd last_half;  // [1/s] of the second half of the time alone: how far they have settled
  std::string none;           // as of MotionTangent
};

/// Throws std::invalid_argument for a count that the scene does not have, and for times that are not > 0 (transient:
/// >= 0); std::runtime_error as differentiate_motion() does.
Lyapunov lyapunov_exponents(const System& system, const EventDrivenOptions& options, Solver& solver,
                            const LyapunovClock& clock, const std::atomic<bool>* cancel = nullptr);

}  // namespace orthant
