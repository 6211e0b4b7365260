// solvers/derivatives/active_pattern.h — active pattern of a solution: its unknowns, equations and weakly active rows.
//
//   Near a solution (z, w) the first-order change of the data (ḃ, …; ẇ₀ = Ȧ z + ḃ) determines ż and ẇ, row by row:
//     at a bound, w ≠ 0        ż_i = the bound's change;      friction at a bound:  ż_T = s (μ̇ z_n + μ ż_n),
//                              s = ±1, or −ŵ = −w_T / |w_T| of a disc that slides (De Saxcé's law: it opposes the slip)
//     inside                   ẇ_i = 0;  so both rows of a disc that sticks
//     disc that slides         along s as above; across, on n ⊥ ŵ:  n·ẇ_T + (|w_T| / μ z_n) n·ż_T = 0
//     weakly active            0 ≤ u ⊥ e·ẇ ≥ 0, u the way from the bound along e
//   All of it is ż = p + E y + E_D u,  Pᵀ ẇ + D y = 0,  0 ≤ u ⊥ P_Dᵀ ẇ ≥ 0: E has the unknowns' directions, with the
//   friction that a normal force drags along; P has them without it. Without friction at a bound E = P.
//   Weakly active: both w and the distance to the bound are 0 up to t = max(residual, 20 ρ) (judge/active_set.h); a
//   disc on its edge without slip; friction without slip of a contact that is weakly active itself.
#pragma once

#include <orthant/core/lcp/solution.h>

#include <Eigen/SparseCore>
#include <vector>

namespace orthant {

/// A row that may go either way: how far it is from its bound, and w there.
struct WeaklyActive {
  Index row = 0;
  double distance = 0, w = 0;  // [units of z], [units of w]
};

class ActivePattern {
 public:
  using Sparse = Eigen::SparseMatrix<double>;

  ActivePattern() = default;
  /// `solution` holds z and w as certify() leaves them.
  ActivePattern(const Lcp& problem, const Solution& solution);

  Sparse E, P;                          // n × unknowns
  Eigen::VectorXd D;                    // unknowns
  Sparse E_weak, P_weak;                // n × weakly active directions
  std::vector<Friction> weak_friction;  // among the weakly active directions: normal, first, rows, mu
  std::vector<WeaklyActive> weak;       // ascending
  Vector margin;                        // n [units of w]: what separates the row from another pattern
  Eigen::VectorXd weight;               // n: largest |A_ij| of each row, at least 1
  double threshold = 0;                 // t [units of w]

  /// p of the bounds' changes: vectors of n, n and one entry a friction; an empty one is 0.
  void held(const Vector& lo, const Vector& hi, const Vector& mu, Eigen::VectorXd& p) const;
  /// The gradients with respect to bounds and μ of πᵀ p.
  void held_transposed(const Eigen::VectorXd& pi, Vector& lo, Vector& hi, Vector& mu) const;

 private:
  enum class Place : signed char { lower, upper, inside, weak_lower, weak_upper };
  struct Direction {  // s of a friction at its bound; 0: it is inside, or has no bound to follow
    double s[2] = {0, 0};
    bool follows = false;
  };
  void place_box(const Lcp& problem, const Solution& s);
  void place_friction(const Lcp& problem, const Solution& s);
  void collect(const Lcp& problem);

  struct Entry {
    Index row;
    double value;
  };
  struct Column {
    std::vector<Entry> e, p;
    double d = 0;
  };
  std::vector<Place> place_;  // of box rows; friction rows: inside
  std::vector<char> is_friction_;
  std::vector<Direction> direction_;  // of each friction
  std::vector<Friction> friction_;
  std::vector<double> normal_force_;  // z_n of each friction
  std::vector<Column> free_, weak_columns_;
  std::vector<Index> weak_column_of_;  // of box rows; −1
};

}  // namespace orthant
