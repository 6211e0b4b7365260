// solvers/cones/cone_auto.h — auto on friction discs: cheap steps first, then proximal point, then other starts.
//
//   In this order, each from the best z so far; the log names each:
//     sweeps      block Gauss-Seidel, at most 100, while the rate of the last five promises the end within 40
//     splitting   ADMM from z = 0 (cone_admm.h), while the rate of the last ten promises the end within 100
//     newton      Newton on Alart and Curnier's equations with α = 1e-10, while five steps lower the residual tenfold
//     prox        proximal point (proximal.h), 60 outer iterations
//     path        Tikhonov's path from 0, then proximal point, 120 outer iterations
//     restart     proximal point from 100, 300, 900 sweeps, 250 outer iterations, and from other steps along the path:
//                 which solutions of a redundant problem are met depends on the start
//   Purpose of the first three: sweeps suit loose piles. Splitting suits problems with factors that cost much compared
//   with their entries (a tower of planks: 40 iterations in the time of two Newton steps). Newton alone suits those of
//   full rank.
//   With a time limit each step may take half of the remaining time.
//   Guarantees: none (Coulomb's law is not monotone); the judge decides.
#pragma once

#include <orthant/solvers/cones/cone_admm.h>
#include <orthant/solvers/cones/proximal.h>

namespace orthant {

class ConeAuto final : public ConeSolver {
 public:
  explicit ConeAuto(double tolerance) : tolerance_(tolerance) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double tolerance() const override { return tolerance_; }
  template <class Advance> void while_foreseen(int look, int foreseen, int most, const Advance& advance);
  double tolerance_;
  ProximalPoint point_;
  ConeSplitting splitting_;
  Vector trial_, centre_;
};

}  // namespace orthant
