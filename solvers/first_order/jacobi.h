// solvers/first_order/jacobi.h — projected Jacobi: all rows at once from the last z, damped so that it converges.
//
//   z ← clamp(z − ω D⁻¹ w, lo, hi),  w = A z + b;  then each friction row is clamped to ∓μ z_n of the new z_n.
//     scaling = l1        D_i = √A_ii Σ_j |A_ij| / √A_jj: row sums in units in which the diagonal is 1, so that neither
//                         units nor masses matter  (Delassus: of |W| M⁻¹ |W|ᵀ + R, no less than that, A never formed)
//     scaling = diagonal  D_i = A_ii
//     scaling = spectral  D_i = A_ii λ, λ the estimate of λ_max(diag(A_ii)⁻¹ A) by ten power steps
//   For A symmetric positive semidefinite this is a projected gradient step, and converges when ω < 2 / λ_max(D⁻¹A):
//   with l1 λ_max ≤ 1, so every ω < 2 does; with the diagonal λ_max may be n, but where A is diagonally dominant the
//   step is twice as long. l1 assumes the worst signs: on dense A its steps are up to √n shorter than those of
//   `spectral`, which bears an estimate of half of λ_max with ω = 1, but is no proof.  H₊-matrices converge with l1 and
//   diagonal, ω ≤ 1.  With friction in practice, as pgs.h.
//   The result does not depend on the order of the rows, which may be computed in parallel.
//   O(nnz) an iteration.  D_i ≤ 0 → unsupported (A_ii ≤ 0).  The start value is used.  Ends: first_order.h.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 5; Baker, Falgout, Kolev & Yang, SIAM
//   J. Sci. Comput. 33 (2011) 2864-2887 (the l1 scaling).
#pragma once

#include <orthant/solvers/first_order/first_order.h>

#include <array>

namespace orthant {

struct JacobiOptions {
  enum class Scaling { l1, diagonal, spectral };
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int max_iterations = 100000;
  double omega = 1;  // damping ω
  Scaling scaling = Scaling::l1;
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000000);
    v("omega", omega, 1e-3, 1.999);
    v("scaling", scaling, std::array<std::string_view, 3>{"l1", "diagonal", "spectral"});
  }
};

class Jacobi final : public FirstOrder {
 public:
  using Options = JacobiOptions;
  explicit Jacobi(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override { return detail::diagonal_why_not(problem.A, false); }

 private:
  void load(const Lcp& problem, Vector& z) override;
  Step advance(const Lcp& problem, Vector& z) override;
  int max_iterations() const override { return options_.max_iterations; }
  double tolerance() const override { return options_.tolerance; }

  Options options_;
  detail::RowSums sums_;
  Vector d_, w_, x_, scratch_;
};

}  // namespace orthant
