// solvers/first_order/mprgp.h — MPRGP: conjugate gradients within bounds, proportioning, reduced projections.
//
//   For A symmetric positive semidefinite: minimize ½zᵀAz + bᵀz over lo ≤ z ≤ hi. The gradient w = A z + b splits into
//     φ (free)     w_i between the bounds, 0 on them
//     β (chopped)  what of w_i on a bound points inside
//     φ̃ (reduced)  φ_i cut so that z − ᾱ D⁻¹φ̃ stays inside
//   (norms and steps in the metric D of A's diagonal, ᾱ = step / λ_max(D⁻¹A)), and an iteration is, while
//   ‖β‖² ≤ Γ² φ̃ᵀφ, a step of conjugate gradients on the face;  where that leaves the face, the longest feasible part
//   of it and then the projected z − ᾱ D⁻¹φ (expansion);  else a step along −D⁻¹β (proportioning), which frees rows.
//   The objective falls by a factor 1 − ᾱ λ_min / c, c = c(Γ) ~ 2 + 2Γ², every iteration, for any change of the active
//   set: the rate depends on κ(D^-½ A D^-½), not on number or order of rows; finite for A definite and z not
//   degenerate, or Γ large.
//   One product with A an iteration, two for an expansion. λ_max: ten power steps from b, then the largest Rayleigh
//   quotient met; ᾱ may be up to 2 / λ_max, so step = 1 bears an estimate of half. Any storage, a Delassus operator is
//   not formed.
//   A direction of no curvature along which nothing stops → ray: a proof that there is no solution, which is judged.
//   Free rows and boxes are included. Friction rows hold their bounds while boxes are solved (first_order.h): in
//   practice.
//   A not symmetric or surely not semidefinite → unsupported; found indefinite on the way → stalled.  The start value
//   is used.  Ends: first_order.h.
//   Source: Dostál & Schöberl, Comput. Optim. Appl. 30 (2005) 23-43; Dostál, Optimal Quadratic Programming Algorithms
//   (2009), ch. 5.
#pragma once

#include <orthant/solvers/first_order/first_order.h>

namespace orthant {

struct MprgpOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_iterations = 100000;
  bool stop_early = false;  // as soon as max_iterations would not do (first_order.h)
  double gamma = 1;         // Γ: how unbalanced ‖β‖ may get
  double step = 1;          // ᾱ λ_max
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000000),
        v("stop_early", stop_early);
    v("gamma", gamma, 1e-3, 1e6), v("step", step, 1e-3, 2.0);
  }
};

class Mprgp final : public FirstOrder {
 public:
  using Options = MprgpOptions;
  explicit Mprgp(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override { return detail::quadratic_why_not(problem.A); }

 private:
  void load(const Lcp& problem, Vector& z) override;
  Step advance(const Lcp& problem, Vector& z) override;
  void begin_at(const Lcp& problem, const Vector& z);     // w and direction recomputed
  void free_gradient(const Vector& z);                    // φ from w
  double room(const Vector& z, const Vector& p) const;    // longest t with z − t p within the bounds
  void move(Vector& z, double t, const Vector& p) const;  // z ← z − t p
  void curvature(const Lcp& problem, const Vector& p);    // A p, pᵀAp, and λ_max
  int max_iterations() const override { return options_.max_iterations; }
  int first_look_ahead() const override { return options_.stop_early ? 256 : 0; }
  double tolerance() const override { return options_.tolerance; }

  Options options_;
  detail::HeldBounds bounds_;
  Vector w_, phi_, p_, q_, Ap_, before_, scratch_;
  double pAp_ = 0, largest_ = 0;  // λ_max
  int age_ = 0;                   // iterations since w was a product
};

}  // namespace orthant
