#include <orthant/solvers/cones/proximal.h>

namespace orthant {

Claim Proximal::iterate(Vector& z, int& iterations) {
  point_.load(form(), &budget());
  bool end = false;
  const auto ended = [&](const Vector& x) { return end = finished(x); };
  const auto note = [&](int steps, double merit, double alpha, const char* event) {
    iterations += steps;
    log(iterations, merit, alpha, event);
  };
  for (int k = 0; k < options_.sweeps && !end; ++k) ++iterations, point_.sweeps().sweep(z), ended(z);
  if (!end && options_.path) point_.follow_path(z, 0.5, ended, note);
  if (!end) point_.iterate(z, options_.max_outer, ended, note);
  return end ? Claim::time_limit : Claim::iteration_limit;
}

}  // namespace orthant
