// solvers/first_order/first_order.h — first-order method base: common loop and stopping criterion of PGS and others.
//
//   A method is load() and advance(): one sweep or step on z, and its largest violation, in units of w. The judge is
//   run when this violation falls to the residual that the judge would accept. If the judge refuses (a small change is
//   not yet a small residual), the threshold is lowered in proportion to the excess. So no method stops early, and
//   products for the judge stay rare.
//   Ends: changes below the rounding of z → stalled;  no new least violation in the last seven eighths of at least
//   16384 iterations (divergence, a cycle, a problem without a solution) → stalled;  not finite → numerical_error;
//   iterations used up → iteration_limit, with stop_early as soon as they would not suffice at the rate of the last
//   half, which is evaluated after 128, 256, 512, ... iterations (mprgp: from 512 on).  The last z is kept.
#pragma once

#include <orthant/solvers/solver.h>

#include <optional>

#include <algorithm>
#include <cmath>
#include <string>

namespace orthant {

class FirstOrder : public Solver {
 protected:
  struct Step {
    double violation = 0;  // [units of w]
    bool moved = true;     // false: nothing changes z any more
    double length = 0;     // for the log
    const char* event = "";
    std::optional<Claim> end;     // another reason to stop
    const Vector* ray = nullptr;  // with Claim::ray: its direction
  };

 private:
  virtual void load(const Lcp& problem, Vector& z) = 0;
  virtual Step advance(const Lcp& problem, Vector& z) = 0;
  virtual int max_iterations() const = 0;
  virtual int first_look_ahead() const { return 0; }  // iterations; 0: none (stop_early)
  Claim run(const Lcp& problem, Solution& s, Start start) final;
  Vector last_;  // z before the step: what is reported when a step is not finite
};

namespace detail {

/// largest ← max(largest, value); a NaN stays.
inline void raise(double& largest, double value) {
  if (value > largest || std::isnan(value)) largest = value;
}

/// Empty when all A_ii > 0 (or, with zero allowed, ≥ 0), else the entry in words.
std::string diagonal_why_not(const Matrix& A, bool zero_allowed);

/// Empty when A may be symmetric positive semidefinite: a_ij = a_ji to 1e-12 √(a_ii a_jj), |a_ij| ≤ √(a_ii a_jj). A
/// Delassus operator is. O(nnz), sparse times a logarithm.
std::string quadratic_why_not(const Matrix& A);

/// sums_i ≥ √d_i Σ_j |A_ij| / √d_j, equal where A is stored by entries (a Delassus operator is bounded by its factors):
/// λ_max(diag(sums)⁻¹ A) ≤ 1 and λ_max(diag(d)⁻¹ A) ≤ max_i sums_i / d_i for symmetric A, whatever the units of the
/// rows.
struct RowSums {
  Vector sums;
  void evaluate(const Matrix& A, const Vector& d);

 private:
  Vector x_, inner_;
};

/// Σ_i d_i x_i y_i: products in the metric of the diagonal, in which steps do not depend on the units of single rows.
inline double dot(const Vector& d, const Vector& x, const Vector& y) {
  return (d.array() * x.array() * y.array()).sum();
}

/// The largest Rayleigh quotient xᵀAx / xᵀdx met in ten power steps from b: a lower bound of λ_max(diag(d)⁻¹ A), seldom
/// less than half of it, that the order and the units of the rows do not change. The vectors are scratch.
double largest_ratio(const Matrix& A, const Vector& d, const Vector& b, Vector& x, Vector& Ax, Vector& scratch);

/// Bounds that stand still while a method minimizes: friction rows keep ∓μ z_n of the last hold(). A problem with
/// friction is so a sequence of boxes, each solved to a tenth of what its bounds are off, which converges when μ is not
/// too large (Haslinger's fixed point).
class HeldBounds {
 public:
  Vector lo, hi;
  Vector d;  // A_ii; where that is 0 the largest |A_ij| of the row, or 1

  void load(const Lcp& problem, Vector& z);
  /// Takes the bounds from z, and brings z within them.
  void hold(const Lcp& problem, Vector& z);
  /// max_i d_i |z_i − clamp(z_i − w_i / d_i, …)|, friction rows with their bounds at this z.
  double violation(const Lcp& problem, const Vector& z, const Vector& w);
  /// After violation(): within the bounds held it is a tenth of what it is with new ones.
  bool outdated() const { return held_ <= 0.1 * true_ && held_ < true_; }

 private:
  double row(Index i, double z, double w, double low, double high) const {
    const double r = std::abs(z - std::min(std::max(z - w / d[i], low), high));
    return d[i] * r;
  }
  double held_ = 0, true_ = 0;
};

}  // namespace detail
}  // namespace orthant
