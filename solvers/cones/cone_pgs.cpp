#include <orthant/solvers/cones/cone_pgs.h>

#include <cmath>

namespace orthant {

void ConePgs::begin_conjugate(Index states) {
  norm_ = beta_ = 0;
  if (!options_.conjugate) return;
  for (Vector* each : {&p_, &r_}) each->resize(form().size()), each->setZero();
  for (Vector* each : {&p_state_, &r_state_}) each->resize(states), each->setZero();
}

/// A sweep, after the conjugate move where there is one. Returns ‖z_new − z_old‖ of the sweep.
double ConePgs::sweep(Vector& z, double omega, bool backward) {
  const bool formed = form().formed();
  const auto once = [&] {
    return formed ? sweeps_.sweep(z, omega, backward) : operator_sweeps_.sweep(z, omega, backward);
  };
  if (!options_.conjugate) return once();
  if (!formed && operator_sweeps_.stale()) operator_sweeps_.start(z);
  Vector& state = operator_sweeps_.state();
  p_ *= beta_, z += p_, p_ += r_;  // z by β p; then p ← β p + r
  r_ = z;
  if (!formed) {
    p_state_ *= beta_, state += p_state_, p_state_ += r_state_;
    r_state_ = state;
  }
  const double moved = once(), norm = moved * moved;
  r_ = z - r_;
  if (!formed) r_state_ = state - r_state_;
  beta_ = norm <= norm_ ? norm / norm_ : 0;
  norm_ = norm;
  return moved;
}

Claim ConePgs::iterate_unformed(Vector& z, int& iterations) {
  constexpr int kLook = 5;
  constexpr double kForeseenEnd = 3;  // of the end, a foreseen residual that is worth a look
  if (options_.threads > 1 && !team_) team_ = std::make_unique<ThreadTeam>(options_.threads);
  operator_sweeps_.load(form(), team_.get());
  operator_sweeps_.start(z);
  begin_conjugate(operator_sweeps_.state().size());
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
  begin_conjugate(0);
  double omega = options_.omega, mark = kInf;
  while (iterations < options_.max_sweeps) {
    ++iterations;
    const double moved = sweep(z, omega, options_.symmetric && iterations % 2 == 0);
    const bool end = finished(z);
    log(iterations, residual(), moved);
    if (end) return Claim::time_limit;
    if (!z.allFinite()) return Claim::numerical_error;
    if (moved == 0) return Claim::stalled;
    if (iterations % 10 == 0) {
      if (omega > 1 && residual() > mark) omega = 1;
      mark = residual();
    }
  }
  return Claim::iteration_limit;
}

}  // namespace orthant
