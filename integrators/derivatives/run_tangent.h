// integrators/derivatives/run_tangent.h — derivatives of a planar Moreau–Jean run with respect to parameters and start.
//
//   Forward mode: the tangent of each step (step_tangent.h) after the other, from the tangent of the start. The scene
//   is a function of each parameter: masses, lengths, places, μ, e, clearances, spring and drive parameters alike; the
//   start moves with it, projected onto the joints. These are the derivatives of the discrete run while the sequence of
//   closed contacts, stick and slip stays; not those of the motion that the run approximates.
//   Cost: a run, and for each parameter and step sixteen evaluations of the terms.
#pragma once

#include <orthant/integrators/derivatives/step_tangent.h>
#include <orthant/integrators/simulate.h>

#include <functional>
#include <string>
#include <vector>

namespace orthant {

struct RunParameter {
  std::string name;
  double value = 0;
  std::function<Scene(double)> scene;  // at another value; empty: none of the scene
  Index start = -1;                    // entry of the initial (q, v), 0 … 2 dof − 1, that it is; −1: none
};

/// A step in which rows are weakly active: only one-sided derivatives exist from here on.
struct DegenerateStep {
  double t = 0;               // [s] its begin
  std::vector<int> contacts;  // of the scene
};

struct RunTangent {
  Run run;
  Eigen::MatrixXd q, v;  // dof × parameters, at run.final
  std::vector<DegenerateStep> degenerate;
  long inconsistent = 0;  // steps in which a parameter parts redundant contacts: there is no derivative
};

/// Called at each end of a step, and at the start.
using TangentRecorder = std::function<void(const State&, const Eigen::MatrixXd& dq, const Eigen::MatrixXd& dv)>;

/// Throws std::invalid_argument for what has no derivative here (step_tangent.h), and for a parameter at the end of its
/// range, where no scene lies on one side; std::runtime_error for a step that is not a plain one.
RunTangent differentiate_run(const System& system, const std::vector<RunParameter>& parameters,
                             const MoreauJeanOptions& options, Solver& solver, const Clock& clock,
                             const TangentRecorder& record = {});

}  // namespace orthant
