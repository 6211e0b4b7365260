// experiments/studies/identify/fit.h — friction, restitution and clearance of the slider-crank from a noisy crank
// angle: the worth of derivatives.
//
//   Data: θ₁ at N times by event-driven at the true (μ, e, c), plus normal noise of `sigma`, seeded.
//   min ½ Σ (θ₁(t_i; μ, e, c) − y_i)² / σ²,  in units of the start's values, within bounds
//   by NLopt (gradient-free: BOBYQA, COBYLA, Nelder–Mead; with gradients: L-BFGS, SLSQP), by Ipopt (its limited-memory
//   Hessian) and by Gauss–Newton. Gradients: those of the motion itself (motion_tangent.h), not of a scheme's steps.
//   Error bars: square roots of the diagonal of (Jᵀ J / σ²)⁻¹ at the fit, J = ∂θ₁/∂(μ, e, c): Gauss–Newton's matrix.
#pragma once

#include "experiments/studies/identify/table.h"

namespace orthant {

struct FitPlan {
  double sigma = 1e-3, duration = 0.1;  // [rad] of the noise, [s] of the measurement
  int samples = 100;
  unsigned seed = 1;
};

/// Prints the table and the fit with its error bars.
Table fit_parameters(const FitPlan& plan);

}  // namespace orthant
