#include <orthant/core/support/options.h>
#include <orthant/integrators/event_driven/event_driven.h>
#include <orthant/integrators/between_events/look_ahead.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kUntold = 1e-4;      // independence, of joints that are redundant anyway, of poses not to be passed
constexpr double kSingular = 1e-2;    // independence of the joint rows below which a pose counts as next to singular
constexpr double kNearest = 1e-4;     // likewise: a state is better found from both sides
constexpr double kBlurred = 1e-6;     // likewise: but not from steps with a stage as near as this
constexpr double kTurned = 1e-7;      // of the speeds that make up a gap's rate: its normal has jumped
constexpr double kInstant = 8;        // roundings of the time: no shorter step tells when
constexpr double kMuch = 1e9;         // more of an error than any step is allowed
constexpr double kFewStages = 0.467;  // of a step: the widest interval without a stage of the method is around it
constexpr double kSmallTurn = 0.1;    // [rad] of a body in a step whose stages are near enough to project them there
constexpr int kShortSteps = 15;       // steps in a row, each shorter than
constexpr double kCrowded = 1e-4;     // of a crossing: events are taken to have no end

}  // namespace

EventDriven::EventDriven(const System& system, const Options& options)
    : Integrator(system),
      options_(options),
      motion_(system),
      watch_(motion_),
      transition_(system),
      formulation_(system),
      impact_(system),
      rk_(system.dof()),
      now_(system),
      trial_(system),
      middle_(system),
      earlier_(system),
      q_scale_(system.dof()),
      v_scale_(system.dof()),
      noise_(Eigen::VectorXd::Zero(system.dof())),
      none_(Eigen::VectorXd::Zero(system.dof())),
      bounces_(impulses_.size()),
      touching_(impulses_.size()),
      in_turn_(impulses_.size()),
      released_(impulses_.size()),
      slides_(impulses_.size()),
      held_(impulses_.size()),
      push_(impulses_.size()),
      hit_(impulses_.size()),
      before_(impulses_.size()),
      stepping_(system),
      problem_(&formulation_.problem()) {
  refuse_joint_friction("event-driven");
  refuse_collisions("event-driven");
  events_.reserve(64 * impulses_.size());
  std::fill(watch_.slow.begin(), watch_.slow.end(), options.atol);
}

StepReport EventDriven::step(double h, Solver& solver, State& x) {
  StepReport report;
  report.accepted = 0;
  events_.clear(), why_.clear();
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  formulation_.clear(), problem_ = &formulation_.problem();
  const bool known = good_ && last_q_ == x.q && last_v_ == x.v;
  crossed_ = known ? crossed_ - (x.t - start_) : -kInf;
  start_ = x.t, elapsed_ = known ? -lead_ : 0, lead_ = 0, standstill_ = crowded_ = shared_ = instants_ = 0;
  good_ = known || begin(solver, x, report);
  while (good_ && lead_ == 0 && elapsed_ < h) {
    if (stopped(report)) {
      good_ = false;
      break;
    }
    const double stop = next_stop() - start_;
    good_ = advance(solver, std::min(h, stop), stop > h, report);
    if (good_ && elapsed_ == stop) good_ = renew(solver, report);
  }
  const Point& end = lead_ > 0 ? trial_ : now_;
  x.t = start_ + (lead_ > 0 ? h : elapsed_), x.q = end.q, x.v = end.v;
  gaps_ = end.w.gap;
  const ContactMotion::Residual& residual = lead_ > 0 ? trial_residual_ : residual_;
  report.joint_residual = residual.joint, report.joint_rate = residual.rate;
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
  sort_events();
  if (good_ && !(residual.off <= kJointsHold))
    good_ = fail(report, Status::numerical_error,
                 "the projection onto the joints ends at " + detail::text_of(report.joint_residual) + " m");
  last_q_ = x.q, last_v_ = x.v;
  return report;
}

void EventDriven::remember(Memory& memory) {
  memory(good_, last_q_, last_v_, now_, start_, elapsed_, h_, noise_, lead_, rank_, least_independence_, load_, flight_,
         flight_time_, bounces_, crossing_, crossed_, no_answer_, residual_, motion_, formulation_, impact_, stepping_);
}

/// Those of accumulations lie a little ahead of their place.
void EventDriven::sort_events() {
  const auto earlier = [](const Event& a, const Event& b) { return a.t < b.t; };
  for (auto end = events_.begin(); end != events_.end(); ++end)
    std::rotate(std::upper_bound(events_.begin(), end, *end, earlier), end, end + 1);
}

bool EventDriven::fail(StepReport& report, Status status, std::string why) {
  report.status = status, why_ = std::move(why);
  return false;
}

bool EventDriven::begin(Solver& solver, const State& x, StepReport& report) {
  now_.q = x.q, now_.v = x.v, h_ = options_.first_step;
  flight_ = 0, flight_time_ = 0;
  noise_.setZero(now_.v.size());
  std::fill(bounces_.begin(), bounces_.end(), Bounces{});
  std::fill(motion_.modes.begin(), motion_.modes.end(), ContactMode{});
  motion_.modes_changed();
  residual_ = motion_.project(x.t, now_.q, now_.v);
  rank_ = 0;
  if (!observe(now_, x.t)) return fail(report, Status::numerical_error, "no accelerations at the start");
  return change_modes(solver, {}, report);
}

/// Where a force or its slope jumps next [s]; what is no farther than rounding of the time has been passed.
double EventDriven::next_stop() const {
  return system_.next_breakpoint(start_ + elapsed_ + 4 * kRounding * (std::abs(start_) + std::abs(elapsed_)));
}

/// At a breakpoint: accelerations as they are from now on, and the modes that go with them.
bool EventDriven::renew(Solver& solver, StepReport& report) {
  stop_ = kInf;
  return observe(now_, start_ + elapsed_) ? change_modes(solver, {}, report)
                                          : fail(report, Status::numerical_error, "no accelerations");
}

/// One accepted step, to the time `end` after the start at most, and the event at its end if there is one. last: nothing
/// ends there but the call.
bool EventDriven::advance(Solver& solver, double end, bool last, StepReport& report) {
  const double rest = end - elapsed_;
  stop_ = last ? kInf : std::nextafter(start_ + end, -kInf);
  if (!(h_ > 0)) h_ = first_guess(rest);
  double s = std::min(h_, rest);
  const auto rejected = report.rejected;
  if (system_.contacts() > 0) {
    set_poses(system_, start_ + elapsed_, now_.q, poses_);
    s = std::min(s, horizon(system_, poses_, now_.v, now_.a));
  }
  for (;;) {
    const double error = error_of_step(s),
                 factor = std::clamp(0.9 * std::pow(error, -1 / DormandPrince::kErrorOrder), 0.2, 6.0);
    if (error <= 1) {
      h_ = s < h_ ? std::max(h_, factor * s) : factor * s;
      break;
    }
    if (error < kInf && turns(s) && find_turn(s)) return turn(solver, s, end, report);
    if (report.rejected == rejected) measure_noise();
    ++report.rejected;
    h_ = s *= error < kInf ? factor : 0.1;
    if (s < 1e-3 * kRounding * (std::abs(start_) + elapsed_) + 1e-30)
      return fail(report, Status::stalled,
                  "step size below rounding at t = " + detail::text_of(start_ + elapsed_) +
                      ": the forces grow without bound, or tolerances are too small");
  }
  if (rank_ < system_.joint_rows() && least_independence_ < kUntold)
    return fail(report, Status::numerical_error,
                "redundant joints next to a singular pose at t = " + detail::text_of(start_ + elapsed_) +
                    ": which way they go on is not told; adaptive and the schemes of fixed step pass it");
  const bool early = pass_over(s, rest);
  std::optional<Sign> event;
  while (std::optional<Sign> next = first_sign(s)) {
    const double before = s;
    event.reset();
    if (land(*next, s)) event = next;
    if (!(s < before)) break;  // rounding: found again where the step ends already
  }
  ++report.accepted;
  if (early && last && !event && motion_.lasting().empty()) return look_ahead(rest);
  ++flight_, flight_time_ += s;
  accept(s, end);
  if (crowded_ > (elapsed_ - crossed_ < kSoon * crossing_ ? kShortSteps / 4 : kShortSteps))
    return fail(report, Status::stalled, "events repeat without end at t = " + detail::text_of(start_ + elapsed_)) ||
           cross(solver, end, report);
  return !event || change_modes(solver, event, report) || (no_answer_ && cross(solver, end, report));
}

/// Of a step of s from now_, to trial_, over what is allowed. Next to a singular pose what stages are off the joints by
/// rounding shows in accelerations by 1/δ³: no reason to divide the step further, which would only look closer.
double EventDriven::error_of_step(double s) {
  if (!try_step(s)) return kInf;
  if (turns(s)) return kMuch;
  const double error = rk_.error(s, q_scale_, v_scale_);
  if (least_independence_ >= kSingular || rank_ < system_.joint_rows()) return error;
  return error / std::max(1.0, 1e-16 * std::pow(least_independence_, -1.5) / options_.rtol);
}

/// What rounding of the coordinates makes of the accelerations at now_: no step is held to less. Far from the origin that is
/// much where a contact's normal hangs on a small clearance.
void EventDriven::measure_noise() {
  if (now_.independence < kSingular) return;
  stage_q_ = now_.q;
  for (Index i = 0; i < stage_q_.size(); ++i) stage_q_[i] *= 1 + (i % 2 == 0 ? 2 : -2) * kRounding;
  if (motion_.accelerations(start_ + elapsed_, stage_q_, now_.v, noise_))
    noise_ = (noise_ - now_.a).cwiseAbs();
  else
    noise_.setZero();
}

/// When a singular pose is met, if it is in this step or soon after: δ, the root of the joint rows' independence, goes
/// linearly to zero there and up again.
std::optional<double> EventDriven::pose_in(double s) const {
  const double here = std::sqrt(now_.independence), there = std::sqrt(trial_.independence);
  const double least = std::sqrt(least_independence_);
  if (least_independence_ >= kSingular || rank_ < system_.joint_rows()) return {};
  if (least < there && least < here / 2) return s * here / (here + there);
  if (there < here) return s * here / (here - there);
  return {};
}

/// No step that is gone on from begins or ends next to a singular pose: it ends before, or passes over it with the pose
/// where stages are few. True: the call ends too early for that.
bool EventDriven::pass_over(double& s, double rest) {
  const double first = s;
  std::optional<double> pose = pose_in(s);
  for (int i = 0; i < 8 && pose; ++i) {
    const double clear = 0.4 * h_, across = *pose / kFewStages;
    if (s <= *pose - clear || std::abs(s - across) <= 0.06 * across) return false;
    const double wish = std::min(rest, across <= 1.1 * h_ ? across : *pose - clear);
    if (wish == rest && s == rest) return true;
    s = wish;
    if (error_of_step(s) > 1)
      h_ *= 0.7;
    else
      pose = pose_in(s);
  }
  if (pose) error_of_step(s = first);
  return false;
}

/// Hands out the state at the call's end, next to a singular pose, without going on from it: it is known to ε/δ² only.
/// Very near, it is better known from both sides.
bool EventDriven::look_ahead(double s) {
  lead_ = s;
  for (const double part : {8, 7, 9}) {
    if (least_independence_ >= kNearest) return true;
    const double aside = s / part;
    if (!try_step(s - aside) || least_independence_ < kBlurred) continue;
    std::swap(earlier_, trial_);
    if (!try_step(s + aside) || least_independence_ < kBlurred) continue;
    interpolate(earlier_, trial_, 2 * aside, 0.5, middle_);
    middle_.v = 15 / (16 * aside) * (trial_.q - earlier_.q) - 7.0 / 16 * (earlier_.v + trial_.v) +
                aside / 16 * (trial_.a - earlier_.a);  // of the same polynomial as q: near singular poses it is better
    trial_.q = middle_.q, trial_.v = middle_.v;
    trial_residual_ = motion_.residual(start_ + elapsed_ + s, trial_.q, trial_.v);
    return observe(trial_, start_ + elapsed_ + s);
  }
  return try_step(s);
}

double EventDriven::first_guess(double rest) const {
  const double fast = now_.v.norm() > 0 ? now_.q.norm() / now_.v.norm() : kInf;
  const double turn = now_.a.norm() > 0 ? now_.v.norm() / now_.a.norm() : kInf;
  const double guess = 0.05 * std::min(fast, turn);
  return guess > 0 ? std::min(guess, rest) : rest;
}

/// Of the joint rows, where the accelerations were evaluated last. What is redundant everywhere is no singular pose.
double EventDriven::independence() const { return motion_.basic().rank() < rank_ ? 0 : motion_.basic().independence(); }

bool EventDriven::observe(Point& p, double t) {
  if (!orthant::observe(motion_, t, p)) return false;
  // Next to a singular pose rows that are redundant everywhere look independent, as far as rounding goes.
  const int rank = motion_.basic().rank();
  if (rank_ == 0 || (rank > rank_ && motion_.basic().independence() >= kSingular)) rank_ = rank;
  p.independence = independence();
  return true;
}

/// trial_, and push_: the lasting forces' impulses.
bool EventDriven::try_step(double s) {
  for (const int c : motion_.lasting())
    push_[at(c)] = {rk_.first_weight() * now_.w.normal[c], rk_.first_weight() * now_.w.tangent[c]};
  const double t = start_ + elapsed_;
  double turn = 0;
  for (Index i = 2; i < now_.v.size(); i += 3) turn = std::max(turn, s * std::abs(now_.v[i]));
  const bool close = turn < kSmallTurn;
  const auto acceleration = [&](double time, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a) {
    time = std::min(time, stop_);
    bool possible = motion_.accelerations(time, q, v, a);
    if (close && independence() < kSingular) {
      stage_q_ = q, stage_v_ = v;
      motion_.project(time, stage_q_, stage_v_);
      possible = motion_.accelerations(time, stage_q_, stage_v_, a);
    }
    least_independence_ = std::min(least_independence_, independence());
    return possible;
  };
  least_independence_ = 1;
  const auto add_push = [&](double weight) {
    for (std::size_t i = 0; i < motion_.lasting().size(); ++i) {
      Impulse& push = push_[at(motion_.lasting()[i])];
      push.normal += weight * motion_.normal_force(i), push.tangent += weight * motion_.tangent_force(i);
    }
  };
  if (!rk_.step(acceleration, t, now_.q, now_.v, now_.a, s, trial_.q, trial_.v, add_push)) return false;
  q_scale_ = options_.atol + options_.rtol * now_.q.array().abs().max(trial_.q.array().abs());
  v_scale_ = options_.atol + s * noise_.array() + options_.rtol * now_.v.array().abs().max(trial_.v.array().abs());
  const double end = std::min(t + s, stop_);
  free_v_ = trial_.v;
  trial_residual_ = motion_.project(end, trial_.q, trial_.v);
  return trial_residual_.joint < kInf && observe(trial_, end);
}

/// Lasting contact i stands for another normal at the end of the trial step than at its start.
bool EventDriven::turned(std::size_t i, double s) const {
  const double scale = now_.w.gap_rate_scale[motion_.lasting()[i]] + s * motion_.free().lpNorm<Eigen::Infinity>();
  return std::abs(motion_.rate_taken(i)) > options_.atol + std::max(kTurned, 1e3 * options_.rtol) * scale;
}

bool EventDriven::turns(double s) const {
  if (least_independence_ < kSingular) return false;  // velocities are not known well enough to tell
  for (std::size_t i = 0; i < motion_.lasting().size(); ++i)
    if (turned(i, s)) return true;
  return false;
}

/// Shortens the step to where contacts turn. False: what happens sooner has to be looked at first.
bool EventDriven::find_turn(double& s) {
  double low = 0, high = s;
  const auto instant = [&] { return kInstant * kRounding * (std::abs(start_) + elapsed_ + high); };
  while (high - low > instant()) {
    s = (low + high) / 2;
    if (!try_step(s)) return false;
    (turns(s) ? high : low) = s;
  }
  return try_step(s = high) && turns(s) && rk_.error(s, q_scale_, v_scale_) <= 1 && !first_sign(low);
}

/// Takes the trial step, at the end of which contacts have turned: they are let go, and what follows is decided anew.
bool EventDriven::turn(Solver& solver, double s, double end, StepReport& report) {
  released_.assign(released_.size(), false);
  for (std::size_t i = 0; i < motion_.lasting().size(); ++i) released_[at(motion_.lasting()[i])] = turned(i, s);
  accept(s, end);
  now_.v = free_v_;
  ++report.accepted, h_ = 0;
  for (int c = 0; c < system_.contacts(); ++c) {
    if (!released_[at(c)]) continue;
    motion_.modes[at(c)] = {};
    events_.push_back({start_ + elapsed_, EventKind::release, c, 0, 0});
  }
  motion_.modes_changed();
  residual_ = motion_.project(start_ + elapsed_, now_.q, now_.v);
  if (!observe(now_, start_ + elapsed_)) return fail(report, Status::numerical_error, "no accelerations");
  return change_modes(solver, {}, report) || (no_answer_ && cross(solver, end, report));
}

double EventDriven::slack(const Sign& sign) const {
  return sign.watch == Watch::gap ? 2 * gap_zero(sign.contact) : watch_.slack(sign);
}

/// The event function; ≥ 0 before the event. A start with overlap is let be.
double EventDriven::value(const Sign& sign, const Watched& w) const {
  return watch_.value(sign, w) - (sign.watch == Watch::gap ? std::min(0.0, now_.w.gap[sign.contact]) : 0);
}

std::optional<Sign> EventDriven::first_sign(double s) {
  std::optional<Sign> first;
  if (s <= 0) return first;
  if (!motion_.lasting().empty() && watch_.look(start_ + elapsed_, s, now_, trial_, stop_)) first = watch_.first();
  const Watched &a = now_.w, &b = trial_.w;
  for (int c = 0; c < system_.contacts(); ++c) {
    if (motion_.modes[at(c)].lasting) continue;
    const double shift = std::min(0.0, a.gap[c]);
    const auto found = first_crossing(quintic(a.gap[c] - shift, a.gap_rate[c], a.gap_acceleration[c], b.gap[c] - shift,
                                              b.gap_rate[c], b.gap_acceleration[c], s),
                                      2 * gap_zero(c));
    if (found && !(first && first->crossing.x <= found->x)) first = Sign{Watch::gap, c, *found};
  }
  return first;
}

/// Shortens the step to where the function is zero. False: it is not there, it only came near; s is shortened all the same.
bool EventDriven::land(const Sign& sign, double& s) {
  const double tiny = slack(sign) / 2;
  double low = 0, high = s, x = sign.crossing.x * s, slope = sign.crossing.slope / s, last_x = 0, last = 0;
  bool bracketed = value(sign, trial_.w) < 0;
  for (int i = 0; i < 80; ++i) {
    if (!try_step(x)) break;
    s = x;
    const double f = value(sign, trial_.w);
    if (sign.watch == Watch::gap)
      slope = trial_.w.gap_rate[sign.contact];
    else if (sign.watch == Watch::slip)
      slope = motion_.modes[at(sign.contact)].slip * trial_.w.slip_acceleration[sign.contact];
    else if (i > 0 && x != last_x)
      slope = (f - last) / (x - last_x);
    if (std::abs(f) <= tiny) return true;
    (f > 0 ? low : high) = x;
    bracketed = bracketed || f < 0;
    if (f > 0 && !(slope < 0) && !bracketed) return false;
    last_x = x, last = f;
    double next = x - f / slope;
    if (!(slope < 0) || !(next > low && next < high)) next = (low + high) / 2;
    if (std::abs(next - x) <= kRounding * x) return true;
    x = next;
  }
  return true;
}

void EventDriven::accept(double s, double end) {
  const double before = elapsed_;
  load_ = std::max(load_, now_.w.normal.size() > 0 ? now_.w.normal.maxCoeff() : 0);
  std::swap(now_, trial_);
  residual_ = trial_residual_;
  elapsed_ = s < end - elapsed_ ? elapsed_ + s : end;
  standstill_ = elapsed_ > before ? 0 : standstill_ + 1;
  const bool crowd = s < kCrowded * options_.crossing;
  crowded_ = crowd ? crowded_ + 1 : 0, shared_ = crowd ? shared_ : 0;
  for (const int c : motion_.lasting())
    impulses_[at(c)].normal += s * push_[at(c)].normal, impulses_[at(c)].tangent += s * push_[at(c)].tangent;
}

}  // namespace orthant
