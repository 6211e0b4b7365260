#include <orthant/solvers/cones/cone_pgs.h>

namespace orthant {

Claim ConePgs::iterate(Vector& z, int& iterations) {
  sweeps_.load(form());
  double omega = options_.omega, mark = kInf;
  while (iterations < options_.max_sweeps) {
    ++iterations;
    const double moved = sweeps_.sweep(z, omega, options_.symmetric && iterations % 2 == 0);
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
