#include <orthant/solvers/active_set/polish.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace orthant {

namespace {

constexpr int kGuesses = 4, kRounds = 8;

/// By the judge's own allowance for rounding (certify.h).
bool is_exact(const Solution& s) { return has_answer(s.status); }

/// What is not known of w counts as wrong, or else a runaway z would do.
double error(const Solution& s) { return std::max(s.residual, s.rounding); }

}  // namespace

/// Judges z, clamped to the bounds; the best so far is kept.
bool Polish::better(const Lcp& p, const Vector& z) {
  trial_.z = z.cwiseMax(p.lo).cwiseMin(p.hi);
  const auto judge = [&](Solution& s) {
    judge_.certify(p, 0, Claim::stalled, s);
    if (judge_.coarse()) s.status = Status::stalled;  // a better one is looked for
  };
  judge(trial_);
  if (!is_exact(trial_) && at_bounds_.put(p, trial_, put_.z)) {
    judge(put_);
    if (is_exact(put_) || error(put_) < error(trial_)) std::swap(trial_, put_);
  }
  const bool smaller = error(trial_) < error(best_);
  if (each_row_ && is_exact(trial_) != is_exact(best_) ? !is_exact(trial_) : !smaller) return false;
  best_ = trial_;
  return true;
}

/// Sides from the best z and its w.
void Polish::guess(const Lcp& p, int kind, const Budget& budget) {
  rows_.load(p, best_.z, budget);
  if (kind == 0 || kind == 3) return;
  const double clear = kind == 1 ? 1e-4 : 1e-9;
  const double size = p.size() > 0 ? best_.z.lpNorm<Eigen::Infinity>() : 0;
  for (Index i = 0; i < p.size(); ++i) {
    const double low = best_.z[i] - p.lo[i], high = p.hi[i] - best_.z[i];
    const double gap = clear * std::max(size, std::abs(best_.w[i]) / rows_.scale(i));
    rows_.side[at(i)] = std::min(low, high) > gap ? Side::inside : low <= high ? Side::lower : Side::upper;
  }
}

bool Polish::improve(const Lcp& p, Vector& z, const Budget& budget, bool each_row) {
  each_row_ = each_row;
  best_.residual = best_.rounding = kInf;
  best_.status = Status::not_run;
  better(p, z);
  zero_ = Eigen::VectorXd::Zero(p.size());
  if (!(error(best_) < kInf)) return false;
  for (int kind = 0; kind < kGuesses && !is_exact(best_) && !budget.exhausted(); ++kind) {
    guess(p, kind, budget);
    for (int round = 0; round < kRounds && !budget.exhausted(); ++round) {
      if (!rows_.solve() && !rows_.solve_near(kind == 3 ? zero_ : best_.z)) break;
      better(p, rows_.z);
      if (is_exact(best_) && best_.residual <= best_.rounding) break;
      bool moved = false;
      for (Index i = 0; i < p.size(); ++i) {
        const Side side = rows_.better(i);
        moved = moved || side != rows_.side[at(i)];
        rows_.side[at(i)] = side;
      }
      if (!moved) break;
    }
  }
  z = best_.z;
  return is_exact(best_);
}

}  // namespace orthant
