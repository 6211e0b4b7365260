#include <orthant/core/support/kept_memory.h>
#include <orthant/solvers/cones/cone_pgs.h>

#include <algorithm>
#include <cmath>

namespace orthant {

void ConePgs::begin(const Vector& z) {
  pairs_ = Pairs::ahead, least_ = kInf, begun_ = 0;
  rest(z);
}

/// Pairs begin anew from z.
void ConePgs::rest(const Vector& z) {
  momentum_ = 1, mixing_begun_ = false;
  if (options_.accelerated) before_ = z, state_before_ = operator_sweeps_.state();
}

/// Another kind of pairs where the residual last found is none that falls.
void ConePgs::watch(const Vector& z, int iterations) {
  constexpr int kPatience = 200;
  constexpr double kFalls = 0.9;
  if (!options_.accelerated) return;
  if (residual() < kFalls * least_) {
    least_ = residual(), begun_ = iterations;
  } else if (iterations - begun_ >= std::max(kPatience, begun_ / 2)) {
    pairs_ = pairs_ == Pairs::ahead ? Pairs::plain : pairs_ == Pairs::plain ? Pairs::mixed : Pairs::ahead;
    begun_ = iterations;
    rest(z);
  }
}

/// z, the image of the last pair, becomes the next one's start.
void ConePgs::mix(Vector& z) {
  if (mixing_begun_) {
    mixing_.next(before_, z), z = before_;
    if (!form().formed()) operator_sweeps_.start(z);
  } else {
    mixing_.restart(), before_ = z, mixing_begun_ = true;
  }
}

/// A sweep, or a pair of them from a point ahead. Returns ‖z_new − z_old‖ of the sweep, or of the pair.
double ConePgs::sweep(Vector& z, double omega, bool backward) {
  const bool formed = form().formed();
  const auto once = [&](bool back) {
    return formed ? sweeps_.sweep(z, omega, back) : operator_sweeps_.sweep(z, omega, back);
  };
  if (!options_.accelerated) return once(backward);
  if (pairs_ == Pairs::mixed) mix(z);
  if (pairs_ != Pairs::ahead) return once(false) + once(true);
  if (!formed && operator_sweeps_.stale()) {  // both: momentum would carry on the rounding of one, ever larger
    operator_sweeps_.start(before_), state_before_ = operator_sweeps_.state();
    operator_sweeps_.start(z);
  }
  const double next = (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2, beta = (momentum_ - 1) / next;
  momentum_ = next;
  const auto move_ahead = [beta](Vector& x, Vector& before, Vector& ahead) {
    ahead = x + beta * (x - before), before = x, x = ahead;
  };
  move_ahead(z, before_, ahead_);
  if (!formed) move_ahead(operator_sweeps_.state(), state_before_, state_ahead_);
  once(false), once(true);
  if ((ahead_ - z).dot(z - before_) > 0) momentum_ = 1;
  return (z - ahead_).norm();
}

void ConePgs::release() {
  ConeSolver::release();
  sweeps_ = {}, operator_sweeps_.release();
  free_memory(before_, ahead_, state_before_, state_ahead_, mixing_);
}

Claim ConePgs::iterate_unformed(Vector& z, int& iterations) {
  constexpr int kLook = 5;
  constexpr double kForeseenEnd = 3;  // of the end, a foreseen residual that is worth a look
  if (options_.threads > 1 && !team_) team_ = std::make_unique<ThreadTeam>(options_.threads);
  operator_sweeps_.load(form(), team_.get());
  operator_sweeps_.start(z);
  if (finished(z, operator_sweeps_.residual(z))) return Claim::time_limit;
  begin(z);
  double omega = options_.omega, mark = kInf, last = kInf;
  while (iterations < options_.max_sweeps) {
    ++iterations;
    const double moved = sweep(z, omega, options_.symmetric && iterations % 2 == 0);
    if (!std::isfinite(moved)) return Claim::numerical_error;
    const double foreseen = moved * (moved / last);
    last = moved;
    if (moved != 0 && iterations != 1 && iterations % kLook != 0 && foreseen > kForeseenEnd * target() * form().norm_q)
      continue;
    const bool end = finished(z, operator_sweeps_.residual(z));
    log(iterations, residual(), moved);
    if (end) return Claim::time_limit;
    if (moved == 0) return Claim::stalled;
    watch(z, iterations);
    if (iterations % 10 == 0) {
      if (omega > 1 && residual() > mark) omega = 1;
      mark = residual();
    }
  }
  return Claim::iteration_limit;
}

Claim ConePgs::iterate(Vector& z, int& iterations) {
  if (!form().formed()) return iterate_unformed(z, iterations);
  sweeps_.load(form());
  begin(z);
  double omega = options_.omega, mark = kInf;
  while (iterations < options_.max_sweeps) {
    ++iterations;
    const double moved = sweep(z, omega, options_.symmetric && iterations % 2 == 0);
    const bool end = finished(z);
    log(iterations, residual(), moved);
    if (end) return Claim::time_limit;
    if (!z.allFinite()) return Claim::numerical_error;
    if (moved == 0) return Claim::stalled;
    watch(z, iterations);
    if (iterations % 10 == 0) {
      if (omega > 1 && residual() > mark) omega = 1;
      mark = residual();
    }
  }
  return Claim::iteration_limit;
}

}  // namespace orthant
