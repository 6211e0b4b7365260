// solvers/first_order/sweeps.h — projected relaxation sweep: kernel of pgs, psor, sgs, nncg for every storage of A.
//
//   For each row in turn, w_i from the newest z:   z_i ← clamp(z_i − ω w_i / A_ii, lo_i, hi_i);
//   a friction row's bounds are ∓μ z_n at the newest z_n; a free (equality) row has none.
//   The `state`, an affine function of z, makes w_i cheap. It follows each change of z_i:
//     dense      w = A z + b                w_i is at hand, a change costs column i: rows at their bounds are free
//     sparse     none                       w_i = A_i z + b_i
//     Delassus   u = M⁻¹ Wᵀ z               w_i = W_i u + R_i z_i + b_i: A is never formed
//   O(nnz) a sweep, Delassus O(nnz(W)). The state is recomputed every 64 sweeps, lest rounding pile up.
//   Sources: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 5; Jean, CMAME 177 (1999) 235-257.
#pragma once

#include <orthant/solvers/first_order/first_order.h>

#include <vector>

namespace orthant {

class Sweeps {  // reuse it: the second problem of a size allocates nothing
 public:
  enum class Order { forward, backward };
  struct Change {
    double largest = 0;  // max_i |Δz_i| A_ii [units of w]
    bool moved = false;  // some Δz_i is more than the rounding of z_i
    int switched = 0;    // rows that went to another side: lo, hi, or between
    Change operator+(const Change& b) const {
      return {std::max(largest, b.largest), moved || b.moved, switched + b.switched};
    }
  };

  /// The problem of the following sweeps, which must outlive them. A_ii > 0.
  void load(const Lcp& problem, const Vector& z);
  Change sweep(Vector& z, double omega, Order order = Order::forward);

  const Vector& diagonal() const { return diagonal_; }
  Vector& state() { return state_; }  // to be moved with z by who moves z along a line

 private:
  void refresh(const Vector& z);
  template <class Rows> Change run(const Rows& rows, Vector& z, double omega, Order order);

  const Lcp* problem_ = nullptr;
  Vector diagonal_, state_, scratch_;
  std::vector<Index> friction_of_;  // per row: its entry of problem.friction, or −1
  std::vector<signed char> side_;   // per row: −1, 0, 1 at lo, between, at hi
  int since_refresh_ = 0;
};

/// Common part of solvers made of sweeps.
class SweepSolver : public FirstOrder {
 public:
  std::string why_not(const Lcp& problem) const override { return detail::diagonal_why_not(problem.A, false); }

 protected:
  void load(const Lcp& problem, Vector& z) override { sweeps_.load(problem, z); }
  static Step step(const Sweeps::Change& change) { return {change.largest, change.moved}; }
  Sweeps sweeps_;
};

}  // namespace orthant
