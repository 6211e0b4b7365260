#include <orthant/solvers/cones/newton_ac.h>

#include <algorithm>

namespace orthant {

namespace {

constexpr double kLeastAlpha = 1e-10;  // α
constexpr int kStepsAnAlpha = 10;      // with one α

}  // namespace

Claim NewtonAc::iterate(Vector& z, int& iterations) {
  sweeps_.load(form());
  for (int k = 0; k < options_.sweeps; ++k) {
    sweeps_.sweep(z);
    if (finished(z)) return Claim::time_limit;
  }
  newton_.load(form(), &budget());
  double alpha = kLeastAlpha, last = residual();
  while (iterations < options_.max_steps) {
    centre_ = z;
    const auto out = newton_.solve(
        {.map = options_.map, .alpha = alpha, .max_steps = std::min(kStepsAnAlpha, options_.max_steps - iterations)},
        centre_, z);
    iterations += std::max(out.steps, 1);
    const bool end = finished(z);
    log(iterations, residual(), alpha, out.steps == 0 ? "singular" : "");
    if (end) return Claim::time_limit;
    alpha = residual() < 0.5 * last ? std::max(alpha / 10, kLeastAlpha) : std::min(alpha * 100, 0.1);
    last = residual();
  }
  return Claim::iteration_limit;
}

}  // namespace orthant
