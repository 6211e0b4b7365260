// solvers/pivoting/path.h — PATH-like Newton method on the normal map: each step is a path found by pivoting.
//
//   A zero of F(π(x)) + x − π(x), π the projection on [lo, hi], is a solution z = π(x): complementary rows, free rows
//   and boxes alike. From a start value:
//     1. crash     projected Newton steps, z ← π(z + α d), d solving the rows that are not at a bound they press
//                  against: finds most of the active set in a few factorizations. [Dirkse & Ferris 1995]
//                  Cold, linear, sparse Z-matrices (obstacle problems) begin on coarse problems (coarse_start.h).
//     2. step      F replaced by its linearization at z; normal_path.h follows the path from x to a zero of that map.
//     3. search    the end of the path is taken when the merit ½‖Φ‖² (fischer_burmeister.h) falls below the largest of
//                  the last few; up to `watchdog` steps may be accepted without decrease; else back to the last good
//                  point, and along the breakpoints of its path; else along the gradient of the merit.
//     4. proximal  where a basis is singular in free variables, or a path ends on a ray, ε (z − z_k) is added to F.
//     5. restarts  a table of variations, in path.cpp: other starts, Lemke's ray, long double, 256 bits (scalars.h; up
//                  to 600 rows, linear), other coverings.
//   A linear problem takes one step, from the crash point or (variation 2) as Lemke's method in revised form.
//   Friction rows take the copositive pure form (pure_form.h, stewart_trinkle); all else is native. Dense: O(n²) a
//   pivot; RowSparse: factors by KLU. A linear problem that ends on a ray is searched for a proof (farkas.h).
//   Finds a solution of a linear problem in exact arithmetic where Lemke's method does: P-matrices, xᵀM x ≥ 0.
//   Nonlinear:
//   quadratic convergence near a regular solution; no method is guaranteed to reach it (status stalled).
//   Written after the publications, not after the program of that name.
//   Sources: Ralph, Math. Oper. Res. 19 (1994) 352-389; Dirkse & Ferris, Optim. Methods Softw. 5 (1995) 123-156 and
//   319-345;
//   Ferris & Munson, Comput. Optim. Appl. 12 (1999) 207-227; Ferris, Kanzow & Munson, Math. Programming 86 (1999)
//   475-497.
#pragma once

#include <orthant/core/lcp/mcp.h>
#include <orthant/solvers/solver.h>

#include <memory>

namespace orthant {

struct PathOptions {
  double tolerance = 1e-10;  // of a row's data, as certify() measures it; of an Mcp: of the terms of J z and F − J z
  int max_steps = 60;        // linearizations, over one variation of a nonlinear problem
  int max_pivots = 0;        // of one path; 0: 3000 + 50 n
  int max_crash = 50;        // projected Newton steps before the first path, nonlinear at most 2; 0: none
  int memory = 5;            // merits the search compares with: 1 is monotone
  int watchdog = 3;          // steps taken on trust
  int restarts = 13;         // variations tried after the first
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_steps", max_steps, 1, 1000000),
        v("max_pivots", max_pivots, 0, 1000000000), v("max_crash", max_crash, 0, 1000000), v("memory", memory, 1, 100),
        v("watchdog", watchdog, 0, 100), v("restarts", restarts, 0, 13);
  }
};

class Path final : public Solver {
 public:
  using Options = PathOptions;
  explicit Path(const Options& options = {});
  ~Path() override;
  std::string why_not(const Lcp& problem) const override;

  using Solver::solve;
  /// The nonlinear problem, judged by certify() of mcp.h. Warm: s.z is the start; cold: 0, projected on the bounds.
  /// F or J not finite at the start gives numerical_error; elsewhere the search avoids such points. Throws
  /// std::invalid_argument for malformed problems, and whatever the callbacks throw.
  const Solution& solve(const Mcp& problem, Solution& s, Start start = Start::cold);

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) override;
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 1e-12; }  // a right basis, refined, is at rounding level

  Options options_;
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace orthant
