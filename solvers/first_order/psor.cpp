#include <orthant/solvers/first_order/psor.h>

#include <algorithm>
#include <cmath>

namespace orthant {

void Psor::load(const Lcp& problem, Vector& z) {
  SweepSolver::load(problem, z);
  adaptive_ = options_.omega == 0;
  omega_ = adaptive_ ? 1 : options_.omega;
  first_ = rate_ = 0;
  sweeps_done_ = raises_ = 0;
  raised_at_ = 0;
}

void Psor::adapt(const Sweeps::Change& change) {
  constexpr int kWindow = 10, kRaises = 6;
  if (omega_ > 1) {  // does ω keep what it promises?
    const bool over = ++since_ > 10 / (2 - omega_);
    if (over && change.largest > 0.1 * promised_) {
      omega_ = 1, adaptive_ = false;
      return;
    }
    if (over) promised_ = change.largest, since_ = 0;
    if (promised_ == kInf) return;  // the transition to a new ω: its rates are not ω's
  }
  if (change.switched > 0 || first_ == 0) {  // rates of another set of rows tell nothing
    first_ = change.largest, rate_ = 0, sweeps_done_ = 0;
    return;
  }
  if (++sweeps_done_ < kWindow) return;
  const double rate = std::pow(change.largest / first_, 1.0 / kWindow);
  if (rate < 1 && std::abs(rate - rate_) <= 0.1 * (1 - rate) && rate > omega_ - 1 + 0.1 * (2 - omega_)) {
    const double mu = (rate + omega_ - 1) / (std::sqrt(rate) * omega_);
    omega_ = std::clamp(2 / (1 + std::sqrt(std::max(1 - mu * mu, 0.0))), omega_, 1.9999);
    first_ = rate_ = 0;  // the next sweeps are a transition
    if (change.largest < 0.1 * raised_at_) raises_ = 0;
    if (raises_++ == 0) raised_at_ = change.largest;
    if (raises_ > kRaises) omega_ = 1, adaptive_ = false;
    promised_ = kInf, since_ = 0;  // changes grow at first, as slow errors begin to move
    return;
  }
  rate_ = rate, first_ = change.largest, sweeps_done_ = 0;
}

Psor::Step Psor::advance(const Lcp&, Vector& z) {
  const double omega = omega_;
  const Sweeps::Change change = sweeps_.sweep(z, omega);
  if (adaptive_) adapt(change);
  return {.violation = change.largest, .moved = change.moved, .length = omega, .event = omega_ != omega ? "omega" : ""};
}

}  // namespace orthant
