// solvers/cones/facets.h — friction pyramids: Coulomb's disc by n sides, for methods that take linear problems only.
//
//   Each disc ‖z_T‖ ≤ μ z_n becomes the polygon with the corners μ z_n d_k, d_k = (cos θ_k, sin θ_k) at equal angles:
//     z_T = Σ β_k d_k,   0 ≤ β_k ⊥ d_kᵀ w_T + λ ≥ 0,   0 ≤ λ ⊥ μ z_n − Σ β_k ≥ 0                (Stewart & Trinkle)
//   It is inscribed: its strength lies between cos(π/n) and 1 times μ, by direction (n = 4: .707, 8: .924, 16: .981).
//   Other rows stay as they are; β and λ stand behind them. No longer symmetric, copositive where A is semidefinite.
//   Facets solves this with a method, then turns the polygon of each sliding contact so that a corner lies against its
//   slip, and solves again: there the corner has the disc's own answer. The turns are those of regula falsi, per
//   contact, for the angle between corner and slip. The judge checks the disc alone: the answer is `solved` if it
//   satisfies the law of the disc.
//   Solver::set_pyramids() (option facets of each solver): the pyramid's answer is the wanted one, and judged as such.
//   Source: Stewart & Trinkle, Int. J. Numer. Meth. Engng 39 (1996).
#pragma once

#include <orthant/solvers/solver.h>

namespace orthant {

class FacetForm {
 public:
  /// sides ≥ 3; angle: θ_0 of each disc, empty: 0. circumscribed: a pyramid that holds the cone, μ / cos(π/n).
  const Lcp& linear(const Lcp& problem, int sides, const std::vector<double>& angle = {}, bool circumscribed = false);
  /// z of the problem last given to linear() from one of the linear form.
  void restore(const Lcp& problem, const Vector& y, Vector& z) const;
  /// The problem's row that a row of the linear form stands for: of β and λ the disc's first; −1 of −1.
  Index row_of(const Lcp& problem, Index linear_row) const;
  /// The linear form's proof of infeasibility as one for the problem, where the pyramid holds the cone.
  void restore_certificate(const Lcp& problem, const Vector& linear_u, Vector& u) const;

 private:
  struct Disc {
    Index friction = 0, first = 0;  // of Lcp::friction; its first β
    double angle = 0;
  };
  Lcp linear_;
  std::vector<Disc> discs_;
  std::vector<Index> row_;  // of the problem's rows that are no disc rows: place in the linear form, or −1
  int sides_ = 0;
};

class Facets final : public Solver {
 public:
  /// `method` must outlive it. turns = 0: the pyramid's own answer. tolerance: of the judge, on the disc.
  Facets(Solver& method, int sides, int turns, double tolerance = 1e-10)
      : method_(method), sides_(sides), turns_(turns), tolerance_(tolerance) {}
  std::string why_not(const Lcp& problem) const override;
  /// Of the last pyramid, as a linear problem.
  Status pyramid_status() const { return linear_.status; }

 protected:
  bool takes_discs() const override { return true; }

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  double tolerance() const override { return tolerance_; }
  Solver& method_;
  int sides_, turns_;
  double tolerance_;
  FacetForm form_;
  Solution linear_;
};

}  // namespace orthant
