// solvers/active_set/multigrid.h — truncated nonsmooth Newton multigrid: bounds by sweeps, the rest by coarse levels.
//
//   Find z in [lo, hi], w = A z + b as in problem.h, without friction. Projected Gauss-Seidel sweeps find the active
//   rows soon and smooth the error; what is smooth they reduce ever more slowly as the grid is refined. A cycle:
//     1. a projected sweep forward
//     2. rows at a bound with w of the right sign are held; the others take a linear multigrid V-cycle on the levels of
//        coarse_levels.h, truncated: no coarse function moves a held row
//     3. the correction is cut at the bounds;  A symmetric: the step along it that minimizes ½ zᵀAz + bᵀz, else 1
//     4. a projected sweep backward
//   From z = 0 the start comes from the coarse problems Pᵀ A P, Pᵀ b with the bounds of C, two cycles each (nested
//   iteration): the free boundary is then right to a mesh width or two.
//   A symmetric positive definite: steps 1, 3 and 4 never raise the form and sweeps alone converge, so this does; once
//   the active rows are found it is a linear multigrid method. Symmetric M-matrices of grids, 10³ to 10⁶ rows: 11 to 18
//   cycles, O(nnz) each; no factorization. Unsymmetric M-matrices: in practice. Where A has few or no
//   negative entries off the diagonal the levels give little, and the sweeps remain.
//   Memory: the levels take 4 to 5 times as much as A.
//   A_ii ≤ 0 or friction → unsupported.  The start value is used.  Ends: first_order.h; four cycles in a row whose
//   last sweep changes no A_ii z_i by more than 4 ε of the largest → stalled, unless the judge accepts z.
//   Source: Gräser & Kornhuber, J. Comput. Math. 27 (2009) 1-44; Kornhuber, Numer. Math. 69 (1994) 167-184.
#pragma once

#include <orthant/solvers/first_order/first_order.h>
#include <orthant/solvers/linear_algebra/coarse_levels.h>

namespace orthant {

struct MultigridOptions {
  double tolerance = 1e-10;  // accepted residual relative to the data, as certify() measures it
  int max_cycles = 500;
  bool stop_early = false;  // as soon as max_cycles would not do (first_order.h)
  int nested_cycles = 2;    // on each coarse problem, from z = 0; 0: no nested iteration
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_cycles", max_cycles, 1, 1000000000), v("stop_early", stop_early);
    v("nested_cycles", nested_cycles, 0, 100);
  }
};

class Multigrid final : public FirstOrder {
 public:
  using Options = MultigridOptions;
  explicit Multigrid(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  struct Bounded {  // a problem on one level
    const RowSparse* A;
    const Vector *b, *lo, *hi;
  };
  void load(const Lcp& problem, Vector& z) override;
  Step advance(const Lcp& problem, Vector& z) override;
  Step cycle(std::size_t level, const Bounded& p, Vector& z);
  double sweep(const Bounded& p, Vector& z, bool forward, bool& moved) const;
  double correct(std::size_t level, const Bounded& p, Vector& z);  // the step taken
  void nested(const Lcp& problem, Vector& z);
  int max_iterations() const override { return options_.max_cycles; }
  int first_look_ahead() const override { return options_.stop_early ? 8 : 0; }
  double tolerance() const override { return options_.tolerance; }

  Options options_;
  CoarseLevels levels_;
  RowSparse rows_;  // of a matrix that is stored otherwise
  const RowSparse* A_ = nullptr;
  bool symmetric_ = false;
  int still_ = 0;  // cycles so far that changed z by rounding only
  std::vector<char> held_;
  std::vector<int> next_;
  Vector w_, c_, Ac_;
  std::deque<Vector> b_, lo_, hi_, z_;  // of the coarse problems
};

}  // namespace orthant
