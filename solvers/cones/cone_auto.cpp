#include <orthant/solvers/cones/cone_auto.h>

#include <cmath>

namespace orthant {
namespace {

// Iterations foreseen up to which a cheap step goes on: a Newton step costs as much as 10 to 40 of them.
constexpr int kForeseenSweeps = 40, kForeseenSplittings = 100;
constexpr double kFirstPenalty = 0.1;   // ρ
constexpr double kNewtonAlpha = 1e-10;  // α: the problem itself, but for a singular matrix
constexpr int kNewtonSteps = 5;         // after which the residual is to be a tenth

}  // namespace

/// advance() makes an iteration and returns whether there is more. After every `look` of them the residual's rate is to
/// promise the end within `foreseen` further ones.
template <class Advance> void ConeAuto::while_foreseen(int look, int foreseen, int most, const Advance& advance) {
  double mark = residual();
  for (int k = 1; k <= most && advance(); ++k) {
    if (k % look != 0) continue;
    const double rate = std::log(residual() / mark) / look;
    if (!(rate < 0 && std::log(target() / residual()) / rate <= foreseen)) return;
    mark = residual();
  }
}

Claim ConeAuto::iterate(Vector& z, int& iterations) {
  point_.load(form(), &budget());
  bool end = false;
  Budget share;  // of the step under way
  const char* step = "";
  const auto begin = [&](const char* name) {
    step = name;
    share.start(budget().remaining() / 2, budget().cancel());
  };
  const auto ended = [&](const Vector& x) { return (end = finished(x)) || share.exhausted(); };
  const auto note = [&](int steps, double merit, double alpha, const char*) {
    iterations += steps;
    log(iterations, merit, alpha, step);
  };
  const auto sweep = [&] {
    ++iterations;
    return point_.sweeps().sweep(z) > 0 && !ended(z);
  };
  const auto prox = [&](int most) { end || (point_.iterate(z, most, ended, note), end); };
  const auto along_path = [&](double ratio) {
    begin("path"), z.setZero(), point_.restart();
    point_.follow_path(z, ratio, ended, note);
  };

  begin("sweeps");
  while_foreseen(5, kForeseenSweeps, 100, sweep);
  note(0, residual(), 0, "");
  double least = residual();
  const auto keep = [&](const Vector& x) {
    if (residual() < least) least = residual(), z = x;
  };
  if (!end) {
    begin("splitting");
    splitting_.load(form(), &budget());
    trial_.resize(form().size()), trial_.setZero();
    splitting_.start(trial_, kFirstPenalty);
    const auto split = [&] {  // two, as the residual costs as much as one
      iterations += 2;
      if (!splitting_.step() || !splitting_.step() || ended(splitting_.z())) return false;
      keep(splitting_.z());
      return true;
    };
    if (split()) while_foreseen(5, kForeseenSplittings / 2, 200, split);
    note(0, residual(), splitting_.rho(), "");
  }
  if (!end) {
    begin("newton"), trial_ = z;
    for (double mark = kInf; least < 0.1 * mark && !share.exhausted();) {
      mark = least, centre_ = trial_;
      const auto out = point_.newton().solve({.alpha = kNewtonAlpha, .max_steps = kNewtonSteps}, centre_, trial_);
      const bool over = ended(trial_);
      note(out.steps, residual(), kNewtonAlpha, "");
      if (over) break;
      keep(trial_);
    }
  }
  if (!end) begin("prox"), prox(60);
  if (!end) along_path(0.5), prox(120);
  for (int sweeps = 100; sweeps <= 900 && !end && !budget().exhausted(); sweeps *= 3) {  // other starts
    begin("restart"), z.setZero(), point_.restart();
    for (int k = 0; k < sweeps && sweep(); ++k) {
    }
    note(0, residual(), 0, "");
    prox(250);
    if (!end) along_path(sweeps == 100 ? 0.3 : 0.7), prox(120);
  }
  return end ? Claim::time_limit : Claim::stalled;
}

}  // namespace orthant
