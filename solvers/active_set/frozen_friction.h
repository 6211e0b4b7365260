// solvers/active_set/frozen_friction.h — frozen friction: Coulomb friction as a fixed point of box problems.
//
//   z_t ∈ [−μ z_n, μ z_n] with z_n of the round before: symmetric and monotone where A is, as friction itself is not.
//   From z = 0 the first round is the problem without friction; contacts that stick are found in the second or third,
//   those that slide while others press on them at a linear rate (about μ), and in a wedge not at all: on request, the
//   bounds are extrapolated from the last rounds after the first ones (anderson.h).
// A fixed point is a solution. If the iteration reaches none, the judge decides on the last z.
// Source: Panagiotopoulos, Ingenieur-Archiv 44 (1975) 421-432; Haslinger & Tvrdy, Apl. Mat. 28 (1983).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/lcp/solution.h>
#include <orthant/solvers/budget.h>
#include <orthant/solvers/linear_algebra/anderson.h>

#include <algorithm>

namespace orthant {

class FrozenFriction {  // reuse it
 public:
  /// solve_box(problem, z) improves z on a box problem and returns its claim.
  template <class SolveBox> Claim iterate(const Lcp& problem, Vector& z, const Budget& budget, SolveBox&& solve_box) {
    return iterate(
        problem, z, budget, solve_box, [](const Vector&) { return false; }, false);
  }

  /// The same, ended too where done(z) says so of a round's z, friction within its bounds; `mixed`: the bounds are
  /// extrapolated, for large problems, where rounds are dear.
  template <class SolveBox, class Done> Claim iterate(const Lcp& problem, Vector& z, const Budget& budget,
                                                      SolveBox&& solve_box, const Done& done, bool mixed = true) {
    box_ = problem;
    box_.friction.clear();
    Claim claim = Claim::stalled;
    const auto pressed = [&](Eigen::VectorXd& by) {  // z_n of each friction row
      by.resize(static_cast<Index>(problem.friction.size()));
      for (Index k = 0; k < by.size(); ++k) by[k] = std::max(0.0, z[problem.friction[at(k)].normal]);
    };
    pressed(assumed_);
    for (int round = 0; round < kRounds && !budget.exhausted(); ++round) {
      for (Index k = 0; k < assumed_.size(); ++k) {
        const Friction& f = problem.friction[at(k)];
        box_.hi[f.first] = f.mu * assumed_[k];
        box_.lo[f.first] = -box_.hi[f.first];
      }
      before_ = z;
      claim = solve_box(box_, z);
      double change = 0;
      for (const Friction& f : problem.friction)
        change = std::max(change, f.mu * std::abs(z[f.normal] - before_[f.normal]));
      if (!(change > 1e-15 * z.lpNorm<Eigen::Infinity>())) break;
      before_ = z;
      clamp(problem, before_);
      if (done(before_)) break;
      pressed(mixed ? found_ : assumed_);
      if (mixed) mix(round);
    }
    clamp(problem, z);
    return claim;
  }

 private:
  /// Within the bounds to the last bit.
  static void clamp(const Lcp& problem, Vector& z) {
    for (const Friction& f : problem.friction) {
      const double bound = f.mu * std::max(0.0, z[f.normal]);
      z[f.first] = std::clamp(z[f.first], -bound, bound);
    }
  }

  /// The next assumed normals: those found, or what the last rounds make of them.
  void mix(int round) {
    if (round == 0) anderson_.restart();
    if (round < kFree) {
      assumed_ = found_;
    } else {
      anderson_.next(assumed_, found_);
      assumed_ = assumed_.cwiseMax(0.0);
    }
  }

  static constexpr int kRounds = 60, kFree = 3;
  static constexpr Index kDepth = 5;
  Lcp box_;
  Vector before_;
  Eigen::VectorXd assumed_, found_;  // of each friction row
  Anderson anderson_{kDepth};
};

}  // namespace orthant
