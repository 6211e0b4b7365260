// solvers/cones/cone_auto.h — auto on friction discs: sweeps, then proximal point, then from other starts.
//
//   In this order, each from the best z so far, the log names each:
//     sweeps      block Gauss-Seidel while ten sweeps lower the residual by 30 %, at most 100
//     prox        proximal point (proximal.h), 60 outer iterations
//     path        Tikhonov's path from 0, then proximal point, 120 outer iterations
//     restart     proximal point from 100, 300, 900 sweeps, 250 outer iterations, and from other steps along the path:
//                 which solutions of a redundant problem are met depends on the start
//   With a time limit each step may take half of what is left.
//   Guarantees: none (Coulomb's law is not monotone); the judge decides.
#pragma once

#include <orthant/solvers/cones/proximal.h>

namespace orthant {

class ConeAuto final : public ConeSolver {
 public:
  explicit ConeAuto(double tolerance) : tolerance_(tolerance) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double tolerance() const override { return tolerance_; }
  double tolerance_;
  ProximalPoint point_;
};

}  // namespace orthant
