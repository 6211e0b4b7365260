#include <orthant/solvers/cones/cone_auto.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

// Iterations foreseen up to which a cheap step goes on: a Newton step costs as much as 10 to 40 of them.
constexpr int kForeseenSweeps = 40, kForeseenSplittings = 100;
constexpr int kLastSplittings = 10000;
constexpr int kLook = 5;                // sweeps between two looks at the rate
constexpr double kForeseenEnd = 3;      // of the end, a foreseen residual that is worth a look
constexpr double kFirstPenalty = 0.1;   // ρ
constexpr double kNewtonAlpha = 1e-10;  // α: the problem itself, but for a singular matrix
constexpr double kNewtonEnd = 0.3;      // of the end, ‖F‖ at which they are enough
constexpr int kNewtonSteps = 5;         // after which the residual is to be a tenth
constexpr int kInteriorSteps = 10;      // likewise
constexpr int kProximalSteps = 30;  // Newton steps, after which the residual is to be kProximalFall, or near the end
constexpr double kProximalFall = 0.01;
constexpr int kMostInterior = 60;
constexpr Index kNewtonFirst = 30;  // rows up to which a Newton step costs less than two splittings

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

void ConeAuto::begin(const char* name) {
  name_ = name;
  share_.start(budget().remaining() / 2, budget().cancel());
}

bool ConeAuto::ended(const Vector& z) { return (end_ = finished(z)) || share_.exhausted(); }

void ConeAuto::note(int steps, double merit, double size) {
  *iterations_ += steps;
  log(*iterations_, merit, size, name_);
}

void ConeAuto::keep(const Vector& z) {
  if (residual() < least_) least_ = residual(), *z_ = z;
}

/// Sweep number `count` of a run. The residual costs as much as a sweep: it is found after the first, after every
/// kLook, and where the changes of z promise the end.
bool ConeAuto::sweep(Vector& z, int count) {
  ++*iterations_;
  const double moved = point_.sweeps().sweep(z), foreseen = moved * (moved / moved_);
  moved_ = moved;
  if (moved == 0) return ended(z), false;
  const bool look = count == 1 || count % kLook == 0 || foreseen <= kForeseenEnd * target() * form().norm_q;
  return !(look && ended(z));
}

void ConeAuto::split(bool foreseen) {
  splitting_.load(form(), &budget());
  trial_.resize(form().size()), trial_.setZero();
  splitting_.start(trial_, kFirstPenalty);
  const auto advance = [&] {  // two, as the residual costs as much as one
    *iterations_ += 2;
    if (!splitting_.step() || !splitting_.step() || ended(splitting_.z())) return false;
    keep(splitting_.z());
    return true;
  };
  if (foreseen) {
    if (advance()) while_foreseen(5, kForeseenSplittings / 2, 200, advance);
  } else {
    for (int k = 0; k < kLastSplittings / 2 && advance(); ++k) {
    }
  }
  note(0, residual(), splitting_.rho());
}

void ConeAuto::take_newton_steps() {
  trial_ = *z_;
  for (double mark = kInf; least_ < 0.1 * mark && !share_.exhausted();) {
    mark = least_, centre_ = trial_;
    const auto out = point_.newton().solve(
        {.alpha = kNewtonAlpha, .tolerance = kNewtonEnd * target() * form().norm_q, .max_steps = kNewtonSteps}, centre_,
        trial_);
    const bool over = ended(trial_);
    note(out.steps, residual(), kNewtonAlpha);
    if (over) return;
    keep(trial_);
  }
}

void ConeAuto::follow_interior() {
  if (!interior_.load(form(), &budget(), point_)) return;
  double mark = kInf;
  int count = 0;
  const auto log_step = [&](int steps, double merit, double size, const char*) { note(steps, merit, size); };
  const auto over = [&](const Vector& z) {
    if (ended(z)) return true;
    keep(z);
    if (++count % kInteriorSteps != 0) return false;
    const bool slow = !(least_ < 0.1 * mark);
    mark = least_;
    return slow;
  };
  trial_.resize(form().size());
  interior_.iterate(trial_, kMostInterior, false,
                    {.finished = over, .residual = [&] { return residual(); }, .log = log_step});
  point_.restart();
}

void ConeAuto::advance(int most, bool foreseen) {
  if (end_) return;
  double mark = least_;
  int steps = 0;
  const auto over = [&](const Vector& z) {
    if (ended(z)) return true;
    least_ = residual();
    if (!foreseen || steps < kProximalSteps) return false;
    const bool slow = least_ > kProximalFall * mark && least_ > target() / kProximalFall;
    mark = least_, steps = 0;
    return slow;
  };
  point_.iterate(*z_, most, over, [&](int made, double merit, double alpha, const char*) {
    steps += made;
    note(made, merit, alpha);
  });
}

void ConeAuto::follow_path(double ratio) {
  begin("path"), z_->setZero(), point_.restart();
  point_.follow_path(
      *z_, ratio, [&](const Vector& z) { return ended(z); },
      [&](int steps, double merit, double alpha, const char*) { note(steps, merit, alpha); });
}

void ConeAuto::restart() {
  for (int count = 100; count <= 900 && !end_ && !budget().exhausted(); count *= 3) {
    begin("restart"), z_->setZero(), point_.restart();
    for (int k = 1; k <= count && sweep(*z_, k); ++k) {
    }
    if (!end_) ended(*z_);
    note(0, residual(), 0);
    advance(250);
    if (!end_) follow_path(count == 100 ? 0.3 : 0.7), advance(120);
  }
}

void ConeAuto::sweep_first() {
  begin("sweeps");
  int count = 0;
  while_foreseen(kLook, kForeseenSweeps, 100, [&] { return sweep(*z_, ++count); });
  least_ = residual();
  note(0, least_, 0);
}

void ConeAuto::attempt(Method method) {
  switch (method) {
    case sweeps:
      return sweep_first();
    case splitting:
      return begin("splitting"), split(true);
    case newton:
      return begin("newton"), take_newton_steps();
    case prox:
      return begin("prox"), advance(60, true);
    case interior:
      return begin("interior"), follow_interior();
    case prox_again:
      return begin("prox"), advance(60);
    case proof:
      begin("proof"), end_ = proved();
      return note(0, least_, 0);
    case path:
      follow_path(0.5), advance(120);
      return restart();
    case splitting_last:
      return begin("splitting"), split(false);
  }
}

Claim ConeAuto::iterate(Vector& z, int& iterations) {
  point_.load(form(), &budget());
  point_.restart();
  z_ = &z, iterations_ = &iterations, end_ = false, least_ = residual();
  const bool few = form().size() <= kNewtonFirst;
  attempt(sweeps);
  for (const Method method : {few ? newton : splitting, few ? splitting : newton})
    if (!end_) attempt(method);
  for (int method = prox; method <= splitting_last && !end_; ++method) attempt(static_cast<Method>(method));
  return end_ ? Claim::time_limit : Claim::stalled;
}

}  // namespace orthant
