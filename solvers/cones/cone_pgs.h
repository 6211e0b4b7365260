// solvers/cones/cone_pgs.h — pgs, psor, sgs, nncg on friction discs: block Gauss-Seidel, exact solve of each contact.
//
//   Sweeps as in cone_sweeps.h, relaxed by ω, forward or forward and backward in turn. Safeguard: where ten sweeps of ω
//   > 1 leave the residual larger, ω falls to 1.
//   conjugate: a sweep G is a step r = G(z) − z of nonlinear conjugate gradients (first_order/nncg.h). Where sweeps alone
//   take a number that grows like the square of a stack's height, these take one that grows like the height. The z that
//   is judged is one that a sweep has just left.
//   Operators of many rows are swept unformed, by several threads (operator_sweeps.h). The residual costs half a sweep
//   there: it is found after the first sweep, after every kLook, and where the changes of z promise the end.
//   No convergence proof for Coulomb's law; with redundant contacts (walls, towers) thousands of sweeps for 1e-4 are
//   common.
#pragma once

#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/cone_sweeps.h>
#include <orthant/solvers/cones/operator_sweeps.h>

#include <memory>

namespace orthant {

class ConePgs final : public ConeSolver {
 public:
  struct Options {
    double tolerance = 1e-10, omega = 1;
    int max_sweeps = 10000;
    bool symmetric = false, conjugate = false;
    int threads = 1;
  };
  explicit ConePgs(const Options& options) : options_(options) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  Claim iterate_unformed(Vector& z, int& iterations);
  double sweep(Vector& z, double omega, bool backward);
  void begin_conjugate(Index states);
  bool takes_operators() const override { return true; }
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  ConeSweeps sweeps_;
  OperatorSweeps operator_sweeps_;
  std::unique_ptr<ThreadTeam> team_;
  Vector p_, r_, p_state_, r_state_;  // conjugate: directions, and what they do to the state of an operator
  double norm_ = 0, beta_ = 0;        // ‖r‖², β: of the move that comes before the next sweep
};

}  // namespace orthant
