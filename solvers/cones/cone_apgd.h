// solvers/cones/cone_apgd.h — apgd on friction discs: accelerated projected gradients, De Saxcé's term from outside.
//
//   Inner problem, convex for A symmetric semidefinite: minimize ½ zᵀA z + (q + s)ᵀz over K, by
//     x⁺ = P_K(y − (A y + q + s)/L),   y⁺ = x⁺ + β (x⁺ − x),   L by backtracking, restart where momentum leads uphill;
//   with s = 0 alone it is the convex relaxation, which lifts a sliding body off by μ |u_T|. Outer: s ← e_n Σ μ_j
//   ‖w_{T_j}‖ each time the inner residual is a tenth of the change of s. First order: to moderate accuracy.
//   Sources: Mazhar, Heyn, Negrut & Tasora, ACM Trans. Graph. 34 (2015); Cadoux, Optimization methods for Coulomb
//   friction (2009): the outer loop.
#pragma once

#include <orthant/solvers/cones/cone_solver.h>

namespace orthant {

class ConeApgd final : public ConeSolver {
 public:
  struct Options {
    double tolerance = 1e-10;
    int max_iterations = 20000;
  };
  explicit ConeApgd(const Options& options) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double project(const Vector& y, const Vector& gradient, double L, Vector& x) const;
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  Vector s_, y_, gradient_, next_, before_, w_, w_next_;
};

}  // namespace orthant
