// solvers/frozen_friction.h — Coulomb friction as a fixed point of box problems, for methods that solve these well.
//
//   z_t ∈ [−μ z_n, μ z_n] with z_n of the round before: symmetric and monotone where A is, as friction itself is not.
//   From z = 0 the first round is the problem without friction; contacts that stick are found in the second or third,
//   those that slide while others press on them at a linear rate (about μ).
// A fixed point is a solution; where there is none to be reached the last z is left to the judge.
// Source: Panagiotopoulos, Ingenieur-Archiv 44 (1975) 421-432; Haslinger & Tvrdy, Apl. Mat. 28 (1983).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/lcp/solution.h>
#include <orthant/solvers/budget.h>

#include <algorithm>

namespace orthant {

class FrozenFriction {  // reuse it
 public:
  /// solve_box(problem, z) improves z on a box problem and returns its claim.
  template <class SolveBox> Status iterate(const Lcp& problem, Vector& z, const Budget& budget, SolveBox&& solve_box) {
    constexpr int kRounds = 60;
    box_ = problem;
    box_.friction.clear();
    Status claim = Status::stalled;
    for (int round = 0; round < kRounds && !budget.exhausted(); ++round) {
      for (const Friction& f : problem.friction) {
        box_.hi[f.row] = f.mu * std::max(0.0, z[f.normal]);
        box_.lo[f.row] = -box_.hi[f.row];
      }
      before_ = z;
      claim = solve_box(box_, z);
      double change = 0;
      for (const Friction& f : problem.friction)
        change = std::max(change, f.mu * std::abs(z[f.normal] - before_[f.normal]));
      if (!(change > 1e-15 * z.lpNorm<Eigen::Infinity>())) break;
    }
    for (const Friction& f : problem.friction) {  // within the bounds to the last bit
      const double bound = f.mu * std::max(0.0, z[f.normal]);
      z[f.row] = std::clamp(z[f.row], -bound, bound);
    }
    return claim;
  }

 private:
  Lcp box_;
  Vector before_;
};

}  // namespace orthant
