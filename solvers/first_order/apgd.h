// solvers/first_order/apgd.h — accelerated projected gradient (Nesterov): step by backtracking, gradient restarts.
//
//   For A symmetric positive semidefinite: minimize ½zᵀAz + bᵀz over lo ≤ z ≤ hi. In the metric D of A's diagonal,
//     x⁺ = clamp(y − D⁻¹(A y + b) / L, lo, hi),   y⁺ = x⁺ + β (x⁺ − x),   β = θ(1 − θ) / (θ² + θ⁺),  θ⁺² = (1 − θ⁺) θ²;
//   L grows to the curvature of the step, ΔᵀAΔ / ΔᵀDΔ, where it is less, up to the row sums of
//   D^-½ |A| D^-½, which never are exceeded, and shrinks by a tenth after each step: the curvature met lies mostly far
//   below the largest.
//   Momentum ends (θ = 1) where it leads uphill, ⟨D(y − x⁺), x⁺ − x⟩ > 0.
//   Error of the objective O(1/k²); linear where A is definite, √κ iterations a digit, by the restarts without knowing
//   κ.
//   One product with A an iteration and one for each growth of L: A y follows from A x. Any storage, Delassus not
//   formed.
//   Free rows and boxes are included. Friction rows hold their bounds while boxes are solved (first_order.h): in
//   practice.
//   A that is not symmetric or surely not semidefinite → unsupported.  The start value is used.  Ends: first_order.h.
//   Sources: Mazhar, Heyn, Negrut & Tasora, ACM Trans. Graph. 34 (2015) 32; O'Donoghue & Candès, Found. Comput. Math.
//   15 (2015) 715-732; Beck & Teboulle, SIAM J. Imaging Sci. 2 (2009) 183-202.
#pragma once

#include <orthant/solvers/first_order/first_order.h>

namespace orthant {

struct ApgdOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_iterations = 100000;
  double shrink = 0.9;  // L after each step: 1 never takes it back
  bool restart = true;  // false: plain acceleration
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000000);
    v("shrink", shrink, 0.1, 1.0), v("restart", restart);
  }
};

class Apgd final : public FirstOrder {
 public:
  using Options = ApgdOptions;
  explicit Apgd(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override { return detail::quadratic_why_not(problem.A); }

 private:
  void load(const Lcp& problem, Vector& z) override;
  Step advance(const Lcp& problem, Vector& z) override;
  void begin_at(const Lcp& problem, const Vector& z);
  int max_iterations() const override { return options_.max_iterations; }
  double tolerance() const override { return options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp

  Options options_;
  detail::HeldBounds bounds_;
  detail::RowSums sums_;
  Vector x_, w_x_, y_, w_y_, next_, w_next_, scratch_;  // points, and A · + b at them
  double curvature_ = 1, largest_ = 1, theta_ = 1;      // L and its bound
};

}  // namespace orthant
