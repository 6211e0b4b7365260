#include <orthant/solvers/cones/cone_auto.h>

namespace orthant {

Claim ConeAuto::iterate(Vector& z, int& iterations) {
  point_.load(form(), &budget());
  bool end = false;
  Budget share;  // of the step under way
  const auto begin_step = [&] { share.start(budget().remaining() / 2, budget().cancel()); };
  const auto ended = [&](const Vector& x) { return (end = finished(x)) || share.exhausted(); };
  const char* step = "sweeps";
  const auto note = [&](int steps, double merit, double alpha, const char*) {
    iterations += steps;
    log(iterations, merit, alpha, step);
  };
  const auto sweep = [&](int most, bool early) {
    double mark = residual();
    for (int k = 1; k <= most; ++k) {
      ++iterations;
      const double moved = point_.sweeps().sweep(z);
      if (ended(z)) break;
      if (moved == 0) break;
      if (early && k % 10 == 0) {
        if (residual() > 0.7 * mark) break;
        mark = residual();
      }
    }
    note(0, residual(), 0, "");
  };
  const auto prox = [&](int most) { end || (point_.iterate(z, most, ended, note), end); };
  const auto along_path = [&](double ratio) {
    step = "path", z.setZero(), point_.restart();
    point_.follow_path(z, ratio, ended, note);
  };
  begin_step(), sweep(100, true);
  if (!end) begin_step(), step = "prox", prox(60);
  if (!end) begin_step(), along_path(0.5), prox(120);
  for (int sweeps = 100; sweeps <= 900 && !end && !budget().exhausted(); sweeps *= 3) {  // other starts
    begin_step(), step = "restart", z.setZero(), point_.restart();
    sweep(sweeps, false), prox(250);
    if (!end) begin_step(), along_path(sweeps == 100 ? 0.3 : 0.7), prox(120);
  }
  return end ? Claim::time_limit : Claim::stalled;
}

}  // namespace orthant
