// solvers/pivoting/revised_lemke.h — revised Lemke's method on an updated factorized basis, for large sparse problems.
//
//   The columns of w − M z − d z₀ = q are I, −M, −d; a basis B of n of them gives x_B = B⁻¹ q. An iteration costs one
//   solve for the entering column u = B⁻¹ a and an update (basis.h), not the O(n²) of a tableau, and what is kept is M
//   itself and the factors. x_B is moved along, and recomputed from the data, refined, at each factorization.
//   Free rows (w_i = 0) have z_i basic from the start and take no part in ratio tests; where their block is singular,
//   each is split, z = z⁺ − z⁻ against ±w ≥ 0.
//   Ratio test: z₀ first; ties as if q were q + ε p with ε → 0 and p > 0 at random, of fixed seed: the least of
//   (B⁻¹ p)_i / u_i, one solve however many rows are tied. An entry below 2⁻³⁶ of its column is no pivot, and a
//   constant below 2⁻⁴⁴ of the largest is 0.
//   Sources: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 4.4; Tomlin, Math. Prog. Study 7
//   (1978).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/budget.h>
#include <orthant/solvers/linear_algebra/basis.h>

#include <vector>

namespace orthant::detail {

class RevisedLemke {  // reuse it
 public:
  enum class End { solved, ray, limit, stopped, lost };  // lost: the basis became singular to working precision

  /// Rows [0, ∞) and free ones, dense or sparse storage. cover: d > 0, n entries. False when not finite.
  /// The budget, which must outlive the run, is polled in every loop whose length grows with n.
  bool load(const Lcp& problem, const Vector& cover, const Budget& budget);

  /// At most `limit` pivots, log(z₀) after each.
  template <class Log> End run(int limit, const Log& log) {
    if (!enter_covering()) return End::solved;
    for (;;) {
      if (iterations_ >= limit) return End::limit;
      const int leaving = exchange();
      if (leaving == kLost) return End::lost;
      if (leaving == covering()) return End::solved;
      log(x_[covering_row_]);
      if (budget_->exhausted()) return End::stopped;
      entering_ = leaving < n_ ? leaving + n_ : leaving - n_;
      if (!price()) return End::lost;
      if (leaving_row_ < 0) return End::ray;
    }
  }

  int iterations() const { return iterations_; }
  void point(Vector& z) const;  // after `solved`
  void ray(Vector& z) const;    // after `ray`: its direction in z

 private:
  static constexpr int kLost = -1;
  int covering() const { return 2 * n_; }
  template <class Add> void column(int variable, const Add& add) const;
  bool factorize();
  bool split();
  void add(int variable, double amount, Vector& z) const;
  bool enter_covering();
  int exchange();  // entering_ against the basic variable of leaving_row_: what left
  bool price();    // u_ and leaving_row_ (−1: nothing blocks) for entering_
  int ratio_test();
  int perturbed();

  int n_ = 0, entering_ = 0, leaving_row_ = -1, covering_row_ = -1, iterations_ = 0;
  Index rows_ = 0;                // of the problem; the rest are twins of split free rows
  std::vector<int> start_, row_;  // M by columns
  std::vector<double> value_;
  std::vector<char> free_;
  Eigen::VectorXd q_, cover_;
  Vector x_, u_, residual_, perturbation_, second_;  // second_: B⁻¹ p
  std::vector<int> basic_, ties_, twin_, origin_;
  std::vector<long double> exact_;
  Basis<double> basis_;
  const Budget* budget_ = nullptr;
};

}  // namespace orthant::detail
