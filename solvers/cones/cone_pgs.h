// solvers/cones/cone_pgs.h — pgs, psor, sgs on friction discs: block Gauss-Seidel with an exact solve of each contact.
//
//   Sweeps as in cone_sweeps.h, relaxed by ω, forward or forward and backward in turn. Safeguard: where ten sweeps of ω
//   > 1 leave the residual larger, ω falls to 1.
//   No convergence proof for Coulomb's law; with redundant contacts (walls, towers) thousands of sweeps for 1e-4 are
//   common.
#pragma once

#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/cone_sweeps.h>

namespace orthant {

class ConePgs final : public ConeSolver {
 public:
  struct Options {
    double tolerance = 1e-10, omega = 1;
    int max_sweeps = 10000;
    bool symmetric = false;
  };
  explicit ConePgs(const Options& options) : options_(options) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  ConeSweeps sweeps_;
};

}  // namespace orthant
