// solvers/cones/cone_pgs.h — pgs, psor, sgs, nncg on friction discs: block Gauss-Seidel, exact solve of each contact.
//
//   Sweeps as in cone_sweeps.h, relaxed by ω, forward or forward and backward in turn. Safeguard: where ten sweeps of ω
//   > 1 leave the residual larger, ω falls to 1.
//   accelerated: a pair of sweeps G, forward and backward, acts like a gradient step in a metric of its own;
//   Nesterov's momentum y = z + β (z − z_before), z ← G(y), β = (θ − 1) / θ⁺, θ⁺ = (1 + √(1 + 4 θ²)) / 2, begins
//   again (θ = 1) where it leads uphill, ⟨y − z⁺, z⁺ − z⟩ > 0. Where sweeps alone take a number that grows like the
//   square of a stack's height, these take one that grows like the height. An iteration is a pair. Coulomb's law has
//   no descent, and momentum may circle for ever: where the least residual stays for kPatience pairs, and half as many
//   as there were, the next ones go without momentum, until they too get nowhere. Then their images are combined
//   (anderson.h): sweeps alone may circle, too, along a few directions.
//   Operators of many rows are swept unformed, by several threads (operator_sweeps.h). The residual costs half a sweep
//   there: it is found after the first sweep, after every kLook, and where the changes of z promise the end.
//   Source of the momentum: O'Donoghue & Candès, Found. Comput. Math. 15 (2015) 715-732.
//   No convergence proof for Coulomb's law; with redundant contacts (walls, towers) thousands of sweeps for 1e-4 are
//   common.
#pragma once

#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/cone_sweeps.h>
#include <orthant/solvers/cones/operator_sweeps.h>
#include <orthant/solvers/linear_algebra/anderson.h>

#include <memory>

namespace orthant {

class ConePgs final : public ConeSolver {
 public:
  struct Options {
    double tolerance = 1e-10, omega = 1;
    int max_sweeps = 10000;
    bool symmetric = false, accelerated = false;
    int threads = 1;
  };
  explicit ConePgs(const Options& options) : options_(options) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  Claim iterate_unformed(Vector& z, int& iterations);
  double sweep(Vector& z, double omega, bool backward);
  void begin(const Vector& z);
  void rest(const Vector& z);
  void mix(Vector& z);
  void watch(const Vector& z, int iterations);
  bool takes_operators() const override { return true; }
  void release() override;
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  ConeSweeps sweeps_;
  OperatorSweeps operator_sweeps_;
  std::unique_ptr<ThreadTeam> team_;
  // Accelerated: z and the state of an operator before the last pair, and where that began.
  Vector before_, ahead_, state_before_, state_ahead_;
  double momentum_ = 1;                                            // θ
  enum class Pairs { ahead, plain, mixed } pairs_ = Pairs::ahead;  // with momentum, without, combined
  Anderson mixing_;
  bool mixing_begun_ = false;  // before_ is where the last pair began
  double least_ = kInf;        // residual since begun_, an iteration
  int begun_ = 0;
};

}  // namespace orthant
