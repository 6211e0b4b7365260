// solvers/active_set/active_rows.h — active rows: rows at a bound, rows with w = 0, and the point they define.
//
//   lower: z_i = lo_i;  upper: z_i = hi_i;  inside: w_i = 0, so that A_FF z_F = −(b_F + A_FN z_N), F = the inside rows.
// Shared by the methods that search for the active rows (block-pivot, newton-min) and those that identify them at the
// end.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/linear_algebra/kernels.h>
#include <orthant/solvers/linear_algebra/principal_block.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace orthant {

enum class Side : char { lower, upper, inside };

class ActiveRows {  // reuse it
 public:
  std::vector<Side> side;
  Vector z, w;

  /// Problems without friction rows. Sides from z and w = A z + b of a guess: where z_i − w_i / d_i leaves the bounds.
  /// Once the budget, which must outlive the calls that follow, is over, every block that is not yet factorized is as a
  /// singular one.
  void load(const Lcp& problem, const Vector& guess, const Budget& budget) {
    problem_ = &problem;
    block_.load(problem.A, &budget);
    diagonal(problem.A, scale_);
    const Index n = problem.size();
    side.resize(at(n));
    z = guess;
    multiply(problem.A, z, w, scratch_);
    w += problem.b;
    for (Index i = 0; i < n; ++i) side[at(i)] = target(i);
  }

  /// All rows inside: where A is an M-matrix (obstacle problems), rows then leave in large blocks, while from the
  /// bounds they enter one layer an iteration. False when A is singular: load() again then.
  bool release_all(bool refined = true) {
    side.assign(side.size(), Side::inside);
    return solve(refined);
  }

  /// z and w of the present choice; false when its block is singular. Not refined, z is as exact as the block's
  /// condition lets one solve be: enough to see which rows are wrong while many are, a tenth of the time less.
  bool solve(bool refined = true) {
    choose(nullptr);
    if (!block_.factorize(inside_)) return false;
    if ((z.array() == 0).all())  // as between bounds 0 and infinity
      w = z;
    else
      multiply(problem_->A, z, w, scratch_);
    step(refined);
    return finish();
  }

  /// Afterwards: as if it had been refined at once.
  bool refine() {
    block_.solve(rhs_, part_);
    for (std::size_t k = 0; k < inside_.size(); ++k) z[inside_[k]] = part_[static_cast<Index>(k)];
    return finish();
  }

  /// The same where the block is singular but its rows can be met, as in monotone problems: the proximal iteration
  ///   z_F ← z_F − (A_FF + ε D)⁻¹ w_F,   D_i = A_ii where that is > 0, else 1,   ε = 1e-8, from z = `near`.
  /// Ends at the solution next to it. False when even that block is singular, or nothing is finite.
  bool solve_near(const Vector& near) {
    choose(&near);
    constexpr double kShift = 1e-8;  // an error outside the null space falls by kShift · condition a step
    shift_.resize(z.size());
    for (Index i = 0; i < z.size(); ++i) shift_[i] = kShift * scale(i);
    if (!block_.factorize(inside_, &shift_)) return false;
    for (int k = 0; k < 4; ++k) {
      multiply(problem_->A, z, w, scratch_);
      step(true);
    }
    return finish();
  }

  /// The side on which row i would be right: where z or w breaks its sign by more than rounding, the other one.
  Side better(Index i) const {
    constexpr double kFew = 64 * std::numeric_limits<double>::epsilon();
    const Lcp& p = *problem_;
    // w is known to a few roundings of its row's terms; an error of z shows as that much in its own row.
    const double w_noise = kFew * size_[i],
                 z_noise = std::min(w_noise / scale(i), 1e-10 * std::abs(z[i]) + kFew * reach_);
    switch (side[at(i)]) {
      case Side::inside:
        return z[i] < p.lo[i] - z_noise ? Side::lower : z[i] > p.hi[i] + z_noise ? Side::upper : Side::inside;
      case Side::lower:
        return w[i] < -w_noise && p.lo[i] < p.hi[i] ? Side::inside : Side::lower;
      default:
        return w[i] > w_noise && p.lo[i] < p.hi[i] ? Side::inside : Side::upper;
    }
  }

  /// The minimum-map's choice at (z, w).
  Side target(Index i) const {
    const Lcp& p = *problem_;
    const double d = scale_[i] > 0 ? scale_[i] : 1.0, moved = z[i] - w[i] / d;
    return moved <= p.lo[i] ? Side::lower : moved >= p.hi[i] ? Side::upper : Side::inside;
  }
  double scale(Index i) const { return scale_[i] > 0 ? scale_[i] : 1.0; }

 private:
  /// The inside rows; z on the bounds elsewhere, `near` (0 when null) inside.
  void choose(const Vector* near) {
    inside_.clear();
    for (Index i = 0; i < problem_->size(); ++i) {
      if (side[at(i)] == Side::inside) inside_.push_back(i);
      z[i] = side[at(i)] == Side::lower   ? problem_->lo[i]
             : side[at(i)] == Side::upper ? problem_->hi[i]
             : near == nullptr            ? 0.0
                                          : (*near)[i];
    }
  }
  /// z_F ← z_F − block⁻¹ (b + w)_F, w = A z.
  void step(bool refined) {
    const auto m = static_cast<Index>(inside_.size());
    rhs_.resize(m);
    for (Index k = 0; k < m; ++k) rhs_[k] = -(problem_->b[inside_[at(k)]] + w[inside_[at(k)]]);
    block_.solve(rhs_, part_, refined);
    for (Index k = 0; k < m; ++k) z[inside_[at(k)]] += part_[k];
  }
  bool finish() {
    const Lcp& p = *problem_;
    if (const auto* dense = std::get_if<DenseMatrix>(&p.A)) {  // half of z is 0, mostly
      w.resize(p.size());
      w.setZero();
      for (Index j = 0; j < p.size(); ++j)
        if (z[j] != 0) detail::subtract(w.data(), -z[j], dense->col(j).data(), p.size());
    } else {
      multiply(p.A, z, w, scratch_);
    }
    size_ = p.b.cwiseAbs() + w.cwiseAbs();
    for (Index i = 0; i < p.size(); ++i) size_[i] += scale(i) * std::abs(z[i]);
    reach_ = p.size() > 0 ? z.lpNorm<Eigen::Infinity>() * std::numeric_limits<double>::epsilon() : 0;
    w += p.b;
    for (const Index i : inside_) w[i] = 0;  // by choice; the judge computes it again
    return z.allFinite();
  }

  const Lcp* problem_ = nullptr;
  PrincipalBlock block_;
  std::vector<Index> inside_;
  Vector rhs_, part_, scratch_, scale_, size_, shift_;
  double reach_ = 0;
};

}  // namespace orthant
