// integrators/integrator.h — the interface that all schemes share: one step, and what it reports.
#pragma once

#include <orthant/core/mechanics/system.h>
#include <orthant/solvers/solver.h>

#include <vector>

namespace orthant {

struct StepReport {
  Status status = Status::solved;  // of the step's complementarity problem; solved when there was none
  double lcp_residual = 0;         // [m/s] as certify() measures it
  int lcp_rows = 0;                // rows of the problem; 0: none was solved
  int lcp_iterations = 0;
  double joint_residual = 0;  // max |Φ| at the end of the step [m, rad]
  double penetration = 0;     // max(0, −gap) at the end of the step [m]
};

struct Impulse {
  double normal = 0, tangent = 0;  // [N s]
};

/// Bound to one system, which must outlive it. Members are scratch: they never change an answer.
class Integrator {
 public:
  explicit Integrator(const System& system)
      : system_(system),
        gaps_(Eigen::VectorXd::Zero(system.contacts())),
        impulses_(static_cast<std::size_t>(system.contacts())) {}
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;
  virtual ~Integrator() = default;

  /// Advances `x` by h > 0 [s]. Unless the report says `solved`, x is exactly as it was.
  virtual StepReport step(double h, Solver& solver, State& x) = 0;

  /// The last step's complementarity problem, to dump and replay; of size 0 when there was none.
  virtual const Lcp& problem() const = 0;

  const System& system() const { return system_; }
  const Eigen::VectorXd& gaps() const { return gaps_; }               // at the end of the last step [m]
  const std::vector<Impulse>& impulses() const { return impulses_; }  // of the last step, one per contact

 protected:
  const System& system_;
  Eigen::VectorXd gaps_;
  std::vector<Impulse> impulses_;
};

}  // namespace orthant
