// solvers/cones/cone_auto.h — auto on friction discs: cheap steps, proximal point, interior-point, other starts.
//
//   In this order, each from the best z so far; the log names each:
//     sweeps      block Gauss-Seidel, at most 100, while the rate of the last five promises the end within 40; the
//                 residual is found where the change of z promises the end, and after every fifth
//     splitting   ADMM from z = 0 (cone_admm.h), while the rate of the last ten promises the end within 100
//     newton      Newton on Alart and Curnier's equations with α = 1e-10, while five steps lower the residual tenfold,
//                 or fewer reach a third of the end; before the splitting, where there are at most 30 rows
//     prox        proximal point (proximal.h), while thirty Newton steps lower the residual a hundredfold, or to a
//                 hundred times the end
//     interior    interior-point from its own start (cone_interior_point.h), while ten iterations lower it tenfold
//     prox        from the best z so far, 60 outer iterations
//     proof       a search for a proof that there is no solution (cone_proof.h)
//     path        Tikhonov's path from 0, then proximal point, 120 outer iterations
//     restart     proximal point from 100, 300, 900 sweeps, 250 outer iterations, and from other steps along the path:
//                 which solutions of a redundant problem are met depends on the start
//     splitting   ADMM again, up to 10000 iterations: slow, but indifferent to where Newton's equations are singular
//   Purpose of the first three: sweeps suit loose piles. Splitting suits problems with factors that cost much compared
//   with their entries (a tower of planks: 40 iterations in the time of two Newton steps). Newton alone suits those of
//   full rank.
//   Interior-point suits redundant contacts under load: piles at rest, where proximal steps take hundreds of factors.
//   With a time limit each step may take half of the remaining time.
//   Guarantees: none (Coulomb's law is not monotone); the judge decides.
#pragma once

#include <orthant/solvers/cones/cone_admm.h>
#include <orthant/solvers/cones/cone_interior_point.h>
#include <orthant/solvers/cones/proximal.h>

namespace orthant {

class ConeAuto final : public ConeSolver {
 public:
  explicit ConeAuto(double tolerance) : tolerance_(tolerance) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double tolerance() const override { return tolerance_; }
  enum Method { sweeps, splitting, newton, prox, interior, prox_again, proof, path, splitting_last };

  template <class Advance> void while_foreseen(int look, int foreseen, int most, const Advance& advance);
  void begin(const char* name);
  bool ended(const Vector& z);
  void note(int steps, double merit, double size);
  void keep(const Vector& z);
  bool sweep(Vector& z, int count);
  void sweep_first();
  void attempt(Method method);
  void split(bool foreseen);
  void take_newton_steps();
  void follow_interior();
  void advance(int most, bool foreseen = false);
  void follow_path(double ratio);
  void restart();

  double tolerance_;
  ProximalPoint point_;
  ConeSplitting splitting_;
  InteriorCones interior_;
  Vector trial_, centre_;
  // Of the solve under way:
  Vector* z_ = nullptr;  // the best so far
  int* iterations_ = nullptr;
  double least_ = kInf;  // its residual
  double moved_ = 0;     // change of z in the last sweep
  bool end_ = false;
  Budget share_;  // of the method under way
  const char* name_ = "";
};

}  // namespace orthant
