#include <orthant/solvers/first_order/nncg.h>

namespace orthant {

void Nncg::load(const Lcp& problem, Vector& z) {
  SweepSolver::load(problem, z);
  for (Vector* each : {&p_, &r_}) each->resize(z.size()), each->setZero();
  for (Vector* each : {&p_state_, &r_state_}) each->resize(sweeps_.state().size()), each->setZero();
  norm_ = beta_ = 0;
}

Nncg::Step Nncg::advance(const Lcp&, Vector& z) {
  Vector& state = sweeps_.state();
  z += beta_ * p_, state += beta_ * p_state_;
  p_ = beta_ * p_ + r_, p_state_ = beta_ * p_state_ + r_state_;
  r_ = z, r_state_ = state;
  const double length = beta_;
  const Sweeps::Change change = sweeps_.sweep(z, 1);
  r_ = z - r_, r_state_ = state - r_state_;
  const double norm = detail::dot(sweeps_.diagonal(), r_, r_);
  beta_ = norm <= norm_ ? norm / norm_ : 0;
  norm_ = norm;
  return {.violation = change.largest, .moved = change.moved, .length = length, .event = beta_ > 0 ? "" : "restart"};
}

}  // namespace orthant
