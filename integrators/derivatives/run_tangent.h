// integrators/derivatives/run_tangent.h — forward mode: tangents of a run of moreau-jean, or in the plane of rattle.
//
//   The tangent of each step (step_linearization.h, rattle_linearization.h, spatial_step_linearization.h) after the
//   other, from the tangent of the start. The scene is a function of each parameter: masses, lengths, places, μ, e,
//   clearances, spring and drive parameters alike; the start moves with it, projected onto the joints. These are the
//   derivatives of the discrete run while the sequence of closed contacts, stick and slip stays; not those of the
//   motion that the run approximates.
//   All parameters go through a step together, as the columns of a block.
//   Cost: a run, the linearization of its steps, and for each parameter three solves a step. Many parameters and few
//   outputs: run_adjoint.h.
#pragma once

#include <orthant/integrators/derivatives/run_notes.h>

namespace orthant {

struct RunTangent {
  Run run;
  Eigen::MatrixXd q, v;  // dof × parameters, at run.final
  std::vector<DegenerateStep> degenerate;
  long inconsistent = 0;              // steps in which a parameter parts redundant contacts: there is no derivative
  std::vector<std::string> warnings;  // of derivatives that are one-sided
};

/// A record: values of the columns, and their derivatives (columns × parameters).
using TangentRecorder = std::function<void(double t, const Eigen::VectorXd& value, const Eigen::MatrixXd& by)>;

/// Records as clock.every says. scheme: {} is moreau-jean. Throws std::invalid_argument for what has no derivative here
/// (step_linearization.h), and for a parameter at the end of its range, where no scene lies on one side;
/// std::runtime_error for a step that is not a plain one, and where derivatives overflow.
RunTangent differentiate_run(const System& system, const std::vector<RunParameter>& parameters,
                             const StepScheme& scheme, Solver& solver, const Clock& clock,
                             const std::vector<RunColumn>& columns = {}, const TangentRecorder& record = {});
/// In space, of moreau-jean. Changes of poses are displacements in the world and turns about the principal axes, those
/// of velocities in the world and about these axes (spatial_step_linearization.h).
RunTangent differentiate_run(const SystemOf<Spatial>& system, const std::vector<RunParameterOf<Spatial>>& parameters,
                             const MoreauJeanOptions& scheme, Solver& solver, const Clock& clock,
                             const std::vector<RunColumn>& columns = {}, const TangentRecorder& record = {});

}  // namespace orthant
