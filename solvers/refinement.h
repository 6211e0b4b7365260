// solvers/refinement.h — refinement: Newton's method from an approximate answer, up to rounding.
//
//   An iterative solver stops at its tolerance, such as 1e-10 of the data. An integrator with error control needs more:
//   a contact that leaves an impact with −1e-10 m/s instead of 0 strikes again, and the motion branches. Answers that
//   are exact to 1e-13 already stay as they are, to the bit.
#pragma once

#include <orthant/solvers/solver.h>

#include <memory>

namespace orthant {

class Refinement {  // reuse it: the members are scratch
 public:
  /// Replaces z, w and residual of a solved s, where the end of Newton's method is solved by the same tolerance and has
  /// a smaller residual.
  void improve(const Lcp& problem, Solution& s);

 private:
  std::unique_ptr<Solver> newton_;  // made when first needed
  Judge judge_;
  Solution trial_;
};

}  // namespace orthant
