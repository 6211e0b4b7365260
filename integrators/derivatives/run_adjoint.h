// integrators/derivatives/run_adjoint.h — reverse mode: gradients of scalars of a run (moreau-jean, planar rattle).
//
//   y_k = Σ_r Σ_c W_rck value_c(record r),  x̄ from the last step to the first by the adjoint of each step
//   (run_tangent.h);  ∂y/∂p = Σ_steps ρ̄ · ∂ρ/∂p + x̄_0 · ∂x_0/∂p
//   Checkpoints: state and memory of the integrator every ⌈√n⌉ of the n steps. From each the steps up to the next are
//   done again, with the same bits, and kept until they are linearized: memory for 2 √n steps.
//   Cost: two runs, the linearization of the steps, and three solves a step and scalar, for any number of parameters
//   that enter linearly (masses, μ, e, …); for the others also evaluations of their elements (parameter_change.h).
//   Source: Griewank & Walther, Evaluating Derivatives (2nd ed., 2008), ch. 3, 12.
#pragma once

#include <orthant/integrators/derivatives/run_notes.h>

namespace orthant {

struct RunAdjoint {
  Run run;
  Eigen::VectorXd value;     // of the scalars
  Eigen::MatrixXd gradient;  // scalars × parameters
  std::vector<DegenerateStep> degenerate;
  long inconsistent = 0;  // steps in which a scalar depends on how redundant contacts share their load
  long checkpoints = 0;
  std::vector<std::string> warnings;  // of derivatives that are one-sided
};

/// Fills W of a record, columns × scalars, which is zero before.
using RecordWeights = std::function<void(long record, bool last, Eigen::MatrixXd& W)>;

/// W = 1 at the last record: the scalars are the columns there. Or at all records: their sums.
RecordWeights weigh_last();
RecordWeights weigh_all();

/// Records as clock.every says. Throws as differentiate_run() does. A run that does not come to its end has no
/// gradient: run.status says why.
RunAdjoint differentiate_run_reverse(const System& system, const std::vector<RunParameter>& parameters,
                                     const StepScheme& scheme, Solver& solver, const Clock& clock,
                                     const std::vector<RunColumn>& columns, Index scalars,
                                     const RecordWeights& weights);

RunAdjoint differentiate_run_reverse(const SystemOf<Spatial>& system,
                                     const std::vector<RunParameterOf<Spatial>>& parameters,
                                     const MoreauJeanOptions& scheme, Solver& solver, const Clock& clock,
                                     const std::vector<RunColumn>& columns, Index scalars,
                                     const RecordWeights& weights);

}  // namespace orthant
