// solvers/pivoting/lemke_howson.h — Lemke-Howson method: an equilibrium of a bimatrix game for each starting label.
//
//   Player 1 has m pure strategies and cost matrix A, player 2 has k and B (both m × k). As an LCP:
//     M = [ 0   A ],  q = −e,   z = (x, y):   A y ≥ e ⊥ x ≥ 0,   Bᵀx ≥ e ⊥ y ≥ 0,   A, B > 0;
//         [ Bᵀ  0 ]
//   strategies x / Σx and y / Σy, expected costs 1 / Σy and 1 / Σx.
//   Costs become gains c − A, c − B > 0; on the polytopes {x ≥ 0, B̂ᵀx ≤ e} and {y ≥ 0, Ây ≤ e} the path that misses
//   one label starts at the origin and ends at an equilibrium; ties are broken lexicographically, so it always ends;
//   where costs span so many orders that rounding makes the path cycle, this is detected and the label is abandoned.
//   Paths from the origin, and on from each equilibrium found, lead to a connected set of them (not always to all).
//   solve(): the first equilibrium, by label 0, 1, …, that the judge accepts (option label: just that one).
//   Any other problem → unsupported (why_not names the missing property). The start value is not used.
//   Source: Lemke & Howson, J. SIAM 12 (1964) 413-423; Cottle, Pang & Stone (1992), ch. 4.4; von Stengel (2002).
#pragma once

#include <orthant/solvers/solver.h>

#include <functional>
#include <vector>

namespace orthant {

struct Equilibrium {
  Eigen::VectorXd x, y;           // mixed strategies: m, k; each sums to 1
  double cost_1 = 0, cost_2 = 0;  // expected: xᵀA y, xᵀB y
  double regret = 0;              // the most a player gains by another strategy: ≥ 0, up to rounding 0; costs' units
  int label = 0;                  // that led here
};

/// One equilibrium of the game with costs A, B (m × k, finite) missing `label` in [0, m + k); any real costs.
/// `stop` is polled at each pivot; where it says true, x and y come back empty.
/// Throws std::invalid_argument for bad shapes, numbers or labels, std::runtime_error where rounding leads in circles.
Equilibrium lemke_howson(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, int label,
                         const std::function<bool()>& stop = {});

/// The different ones that paths connect: over all labels from the origin, then over all labels from each one found;
/// those found until `stop` said true.
std::vector<Equilibrium> lemke_howson_all(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                          const std::function<bool()>& stop = {});

struct LemkeHowsonOptions {
  double tolerance = 1e-10;  // accepted residual relative to the problem's scale, as certify() measures it
  int label = -1;            // −1: all in turn
  template <class V> void visit(V&& v) { v("tolerance", tolerance, 0.0, 1.0), v("label", label, -1, 1000000); }
};

class LemkeHowson final : public Solver {
 public:
  using Options = LemkeHowsonOptions;
  explicit LemkeHowson(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) override;
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 1e-12; }  // a right basis, refined, is at rounding level
  Claim follow(int label, Solution& s);

  Options options_;
  mutable Eigen::MatrixXd A_, B_;     // of the problem that why_not() has looked at
  mutable std::vector<Index> order_;  // its strategies: those of player 1, then of player 2
};

}  // namespace orthant
