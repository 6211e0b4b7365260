// solvers/pivoting/lemke.h — Lemke's method: complementary pivoting; ratio test, anti-cycling: lemke_tableau.h.
//
//   w = M z + q + e z₀:  z₀ enters, covering the most negative q_i. Then the complement of the variable that left
//   enters, until z₀ leaves (a solution) or nothing blocks (a ray).
//     1. form     pure_form.h: friction, boxes → rows [0, ∞) and free;  rows and columns scaled by powers of 2 where
//                 the entries span many orders.
//     2. pivot    lemke_tableau.h: free rows first, then the method, ties broken lexicographically, z₀ first.  O(n²)
//                 a pivot. Where a basis comes back, as rounding has broken ties, another path: up to four other
//                 d for e.
//     3. refine   z_B ← z_B − B⁻¹ (M z + q)_B, the residual in twice double precision, B⁻¹ from the final tableau:
//                 z comes out correctly rounded, so that it depends on the final basis only, not on the path to it or
//                 on the order of rows.
//     4. rescue   when the judge (certify.h) rejects: a proof of infeasibility is searched for (farkas.h); then again
//                 in long double (up to 100 rows), in rationals (up to 24), on factors refined at every pivot
//                 (normal_path.h) and in 256 bits (up to 500 rows; reason: scalars.h), there first on a matrix within
//                 rounding of the given one that redundant contacts leave solvable; in the copositive form, where there
//                 is friction; at last every basis (enumerate.h, up to 12 rows) or other covering vectors.
//                 rescue=false is the plain method.
//   No polynomial bound: Murty's problem takes 2ⁿ pivots. The plain method ends on a solution, where there is one, for
//   P-matrices and for xᵀM x ≥ 0; elsewhere it may end on a ray although a solution exists (status ray).
//   The judge receives a ray's direction and decides whether it is a proof (status infeasible) or not (ray).
//   A start value is not used.   M n × n, any sign structure. The tableau is dense: O(n²) memory, pure form n ≤ 10000;
//   large sparse problems without friction rows and upper bounds take the revised form (revised_lemke.h) instead, and
//   up to 2000 rows the tableau and the rescue after it where the judge rejects what it found.
//   Sources: Lemke, Management Science 11 (1965); Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch.
//   4.4.
#pragma once

#include <orthant/core/lcp/pure_form.h>
#include <orthant/solvers/solver.h>

#include <array>
#include <memory>
#include <string_view>

namespace orthant {

enum class LemkeForm { automatic, tableau, revised };  // automatic: revised for sparse storage from 200 rows on
inline constexpr std::array<std::string_view, 3> kLemkeFormNames = {"automatic", "tableau", "revised"};
enum class LemkeCover { ones, rows };  // d = e, or the largest |M_ij| of each row
inline constexpr std::array<std::string_view, 2> kLemkeCoverNames = {"ones", "rows"};

struct LemkeOptions {
  double tolerance = 1e-10;  // [b] accepted residual relative to ‖b‖∞; rounding level is accepted in any case
  int max_pivots = 0;        // 0: 20000 + 100 n
  LemkeForm form = LemkeForm::automatic;
  LemkeCover cover = LemkeCover::ones;
  bool rescue = true;  // on rejection: proof search, higher precision, other forms and paths
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_pivots", max_pivots, 0, 1000000000), v("rescue", rescue);
    v("form", form, kLemkeFormNames), v("cover", cover, kLemkeCoverNames);
  }
};

class Lemke final : public Solver {
 public:
  using Options = LemkeOptions;
  explicit Lemke(const Options& options = {});
  ~Lemke() override;
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) override;
  bool seeks_proof() const override { return options_.rescue; }
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 1e-12; }  // a right basis, refined, is at rounding level

  bool takes_revised(const Lcp& problem) const;
  Options options_;
  struct Work;  // scratch: it never changes an answer
  std::unique_ptr<Work> work_;
};

}  // namespace orthant
