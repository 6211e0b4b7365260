// integrators/event_driven/refined_solver.h — iterative refinement of a contact problem's solution to rounding.
//
//   Another solver answers, to its tolerance. Its pattern is taken: rows at a bound, contacts that stick, contacts that
//   slip along d = γ_T / |γ_T|. With z = B u, where a contact slips z_T = −μ z_N d, Newton's step is
//     (A B)_basic δu = −(A z + b)_basic,   the δu of least norm,
//   and d is that of the new slip in the next one. Steps are taken while the residual falls. For dense problems of up
//   to 64 rows; others stay as they are.
// Source: Alart & Curnier, Computer Methods in Applied Mechanics and Engineering 92 (1991) 353-375 (the pattern).
#pragma once

#include <orthant/solvers/solver.h>

namespace orthant {

class RefinedSolver final : public Solver {
 public:
  /// Bound to `solver` until the next call; it must outlive the solves.
  Solver& on(Solver& solver) {
    solver_ = &solver;
    return *this;
  }

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  double tolerance() const override { return 1e-10; }
  bool takes_discs() const override { return true; }
  bool seeks_proof() const override { return false; }
  bool step(const Lcp& problem, const DenseMatrix& A, Vector& z);
  double residual(const Lcp& problem, const DenseMatrix& A, const Vector& z) const;

  Solver* solver_ = nullptr;
  Solution inner_;
};

}  // namespace orthant
