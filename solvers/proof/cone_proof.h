// solvers/proof/cone_proof.h — Farkas proofs over friction cones: search by a barrier method.
//
//   No z in the cones has the signs of w = A z + b that the rows demand, if some u has, with g = Aᵀu,
//     u_n ≥ 0 on [lo, ∞), ≤ 0 on (−∞, hi], any on free rows, 0 on friction rows and rows with lo = hi
//     g_n + Σ_j μ_j ‖g_{T_j}‖ ≤ 0 for each contact;  g ≤ 0 on other rows [lo, ∞), ≥ 0 on (−∞, hi], = 0 on free rows
//     bᵀu + Σ g_i bound_i < 0 over the rows with a bound.
//   In the scaled form (cone_form.h) the method maximizes the slack t of these inequalities with Σ |u_n| = 1:
//     min −θ t − Σ_k log det C_k(u, t),   C(u, t) a product of second-order cones,   θ = 1, 8, 64, …
//   by Newton's method from an infeasible start. Centred iterates have t* ≤ t + ν/θ (ν: the degree of the barrier), so
//     t > 0             u is a proof with room for rounding
//     t + ν/θ < 0       there is no proof
//   Where t* = 0, proofs have sums that must be 0: u is tried without its small entries, and in whole numbers, by exact
//   arithmetic (exact_proof.h).
//   Cost: O((n + m) m²) a step for m normals; some 20 steps where t* is not near 0, else 80. At most 400 normals; no
//   boxes.  Source: Boyd & Vandenberghe, Convex Optimization (2004), ch. 5.9, 11; Nesterov & Nemirovskii (1994).
#pragma once

#include <orthant/solvers/budget.h>
#include <orthant/solvers/cones/cone_form.h>

#include <functional>

namespace orthant {

class ConeProof {
 public:
  enum class End { proved, none, open };
  /// proved: proves(u) was true of the last u it was called with. none: there is no proof, up to rounding. open: boxes,
  /// too many rows, late, or t* is too near to 0.
  End search(const Lcp& problem, const Budget& budget, const std::function<bool(const Vector&)>& proves);

 private:
  struct Cone {
    Index first = 0, rows = 1;  // of C_
  };
  bool load(const Lcp& problem);
  void set_cones();
  bool start();
  bool interior(const Eigen::VectorXd& c) const;
  double barrier(const Eigen::VectorXd& c) const;
  bool newton_step(double theta, double& decrement);
  bool try_proof(const Lcp& problem, double share, const std::function<bool(const Vector&)>& proves);

  ConeForm form_;
  std::vector<int> carriers_;  // rows of the form with a u of their own
  std::vector<double> sign_;   // of u there; 0: any
  Eigen::MatrixXd G_;          // g = G u
  Eigen::MatrixXd C_, E_;      // C y in the cones, E y = e, y = (u, v of contacts with several frictions, t)
  Eigen::VectorXd y_, e_;
  std::vector<Cone> cones_;
  Vector scaled_, u_;
};

}  // namespace orthant
