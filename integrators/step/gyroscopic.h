// integrators/step/gyroscopic.h — gyroscopic impulse of a step in space, from the turning of a body's axes, and the
// step's frames.
//
//   Body axes R at the start, F = R exp(a h ω) at q_a, R⁺ = R exp(h ω_m) at the end, ω_m = (1−θ) ω + θ ω⁺, ω = body
//   axes.
//   All rows and unknown velocities of a step stand in the frame F: w⁻ = FᵀR ω = ω (the turn is about ω), w⁺ = FᵀR⁺ ω⁺.
//   Balance of angular momentum, moments τ h in F:   FᵀR⁺ J ω⁺ = FᵀR J ω + h τ.  With the constant J on the left,
//     J (w⁺ − w⁻) = h τ + g,   g = (J − C J Cᵀ) w⁺ − (J − E) ω,   C = FᵀR⁺,  E ω = FᵀR J ω.                     (1)
//   g is (1)'s gyroscopic impulse −h ω × Jω to first order. It is found by repetition.
// Exact for any h: angular momentum in the world, of a free body and under impulses; for θ = ½ the energy of a free
// body, as ω_m · (Jω⁺ − Jω) = 0. g = 0 for bodies with three equal moments: impacts of spheres are exact.
// Schemes of two halves (rattle.h) turn by exp(h u) with one velocity u for the step. With ξ = h u, momenta before and
// after from that of the discrete Lagrangian h u · J u / 2,
//     J ω + h τ/2 = J u + ξ×Ju/2 + c ξ×(ξ×Ju),   J ω⁺ − h τ⁺/2 = J u − ξ×Ju/2 + c ξ×(ξ×Ju),                    (2)
//     c = (1 − |ξ|/2 cot(|ξ|/2)) / |ξ|²,   |ξ| < 2π,
// so that J (u − ω) = h τ/2 + g₁,  J (ω⁺ − u) = h τ⁺/2 + g₂. Angular momentum is exact, too; energy swings with h².
// Source: Simo & Wong, IJNME 31 (1991) 19-52 (the free body); Bou-Rabee & Marsden, FoCM 9 (2009) 197-219 (2).
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

namespace orthant {

struct StepFrames {
  double h = 0, at = 0.5, theta = 0.5;  // [s], a, θ
};

/// g [N m s] of all bodies in the places of their rotations (dof; others are not touched), from v before the step and w
/// after it.
void gyroscopic_impulse(const SystemOf<Spatial>& system, const StepFrames& frames, const Eigen::VectorXd& v,
                        const Eigen::VectorXd& w, Eigen::VectorXd& g);

enum class Half { first, second };
/// g₁ or g₂ of (2) [N m s] of all bodies, in the places of their rotations (dof; others are not touched). False: a body
/// with different moments turns by 2π or more.
bool half_turning_impulse(const SystemOf<Spatial>& system, double h, const Eigen::VectorXd& u, Half half,
                          Eigen::VectorXd& g);

/// w, in the frames of the step, becomes v⁺, in the bodies' axes at its end.
void to_end_axes(const SystemOf<Spatial>& system, const StepFrames& frames, const Eigen::VectorXd& v,
                 Eigen::VectorXd& w);

}  // namespace orthant
