// experiments/studies/verdict_storm/exact_judge.h — a third judge, written apart from certify(): every sum exact.
//
//   Claim of `solved` or `rounded`: an inequality a row (judge/certify.h); here every number in it is rational. With
//   friction discs: cone_judge.h.
//
//   Claim of `infeasible`: uᵀ(A z + b) < 0 for every z within the bounds, u with the signs that make uᵀw ≥ 0 a
//   consequence; exactly, of u or of the vector that it is nearest to (judge/exact_proof.h).
#pragma once

#include <orthant/core/lcp/solution.h>

#include <string>

namespace orthant {

struct Finding {
  bool holds = false;
  double error = kInf;  // of a solution: the largest violation over β; of a proof: the change of u, 0 when u proves
  double margin = 0;    // of a proof: −(the largest uᵀw) over Σ |u_i b_i|; rounding of b changes it by 1e-16
  std::string why;      // empty when it holds
};

/// claimed: solved or rounded.
Finding examine_solution(const Lcp& problem, const Vector& z, double tolerance, Status claimed = Status::solved);
Finding examine_proof(const Lcp& problem, const Vector& u);

}  // namespace orthant
