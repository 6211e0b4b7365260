#include <orthant/core/support/options.h>
#include <orthant/integrators/between_events/look_ahead.h>
#include <orthant/integrators/event_driven/event_driven.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kUntold = 1e-4;      // independence, of joints that are redundant anyway, of poses not to be passed
constexpr double kSingular = 1e-2;    // independence of the joint rows below which a pose counts as next to singular
constexpr double kNearest = 1e-4;     // likewise: a state is better found from both sides
constexpr double kBlurred = 1e-6;     // likewise: but not from steps with a stage as near as this
constexpr double kTurned = 1e-7;      // of the speeds that make up a gap's rate: its normal has jumped
constexpr double kShortest = 8;       // roundings of the time: no shorter step tells when
constexpr double kBehind = 1e4;       // roundings of a gap: how far behind the place where its normal jumps
constexpr double kMuch = 1e9;         // more of an error than any step is allowed
constexpr double kFewStages = 0.467;  // of a step: the widest interval without a stage of the method is around it
constexpr double kSmallTurn = 0.1;    // [rad] of a body in a step whose stages are near enough to project them there
constexpr int kShortSteps = 15;       // steps in a row, each shorter than
constexpr double kCrowded = 1e-4;     // of a crossing: events are taken to have no end
constexpr int kLandings = 200;        // tries to find a step's first event
constexpr double kNowhere = 1e-9;     // of places and sizes: unless bodies move by more in such a step

}  // namespace

EventDriven::EventDriven(const System& system, const Options& options, std::string_view name)
    : Integrator(system, name, kCan),
      options_(options),
      motion_(system),
      watch_(motion_),
      sweep_(system),
      transition_(system),
      formulation_(system),
      impact_(system),
      immobility_(system),
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
      turned_(impulses_.size()),
      released_(impulses_.size()),
      slides_(impulses_.size()),
      tie_(impulses_.size()),
      held_(impulses_.size()),
      push_(impulses_.size()),
      hit_(impulses_.size()),
      before_(impulses_.size()),
      stepping_(system),
      shown_(&formulation_) {
  Substitute::refuse(system, name);
  events_.reserve(64 * impulses_.size());
  for (const Body& body : system.scene().bodies) size_ = std::max(size_, std::sqrt(body.inertia / body.mass));
  if (WorkMeter::needed(system)) meter_.emplace(system);
  std::fill(watch_.slow.begin(), watch_.slow.end(), options.atol);
}

StepReport EventDriven::go(double h, bool one, Solver& solver, State& x) {
  StepReport report;
  report.accepted = 0;
  events_.clear(), why_.clear();
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  formulation_.clear(), shown_ = &formulation_;
  const bool known = good_ && last_q_ == x.q && last_v_ == x.v;
  crossed_ = known ? crossed_ - (x.t - start_) : -kInf;
  work_ = known ? -lead_work_ : 0, lead_work_ = 0;
  start_ = x.t, elapsed_ = known ? -lead_ : 0, lead_ = 0;
  if (!known || !one) standstill_ = crowded_ = shared_ = instants_ = 0, crosses_ = false;
  striding_ = one, arc_.length = 0;
  good_ = known || begin(solver, x, report) || (options_.go_on && cross(solver, h, report));
  for (bool more = good_ && elapsed_ < h; more && lead_ == 0 && elapsed_ < h; more = good_ && !one) {
    if (stopped(report)) {
      good_ = false;
      break;
    }
    const double stop = next_stop() - start_;
    good_ = crosses_ ? cross(solver, std::min(h, stop), report) : advance(solver, std::min(h, stop), stop > h, report);
    if (good_ && elapsed_ == stop) good_ = renew(solver, report) || (options_.go_on && cross(solver, h, report));
  }
  const Point& end = lead_ > 0 ? trial_ : now_;
  if (meter_ && lead_ > 0)
    lead_work_ = meter_->over_motion(start_ + elapsed_, h - elapsed_, now_, trial_, motion_.modes);
  if (meter_) report.work = work_ + lead_work_;
  if (one && lead_ > 0) note_lead();
  x.t = start_ + (lead_ > 0 ? h : elapsed_), x.q = end.q, x.v = end.v;
  gaps_ = end.w.gap;
  const ContactMotion::Residual& residual = lead_ > 0 ? trial_residual_ : residual_;
  report.joint_residual = residual.joint, report.joint_rate = residual.rate;
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
  sort_events();
  if (good_ && !(residual.off <= kJointsHold)) {
    if (one && arc_.length > 0)
      x.t = arc_.start, x.q = arc_.q0, x.v = arc_.v0, arc_.length = 0;  // no arc fits the joints
    good_ = fail(report, Status::numerical_error,
                 "the projection onto the joints ends at " + detail::text_of(report.joint_residual) + " m");
  }
  last_q_ = x.q, last_v_ = x.v;
  return report;
}

void EventDriven::remember(Memory& memory) {
  memory(good_, last_q_, last_v_, now_, start_, elapsed_, h_, noise_, lead_, rank_, least_independence_, load_, flight_,
         flight_time_, bounces_, crossing_, crossed_, crosses_, crossing_status_, crossing_why_, no_answer_, lead_work_,
         residual_, motion_, formulation_, impact_, stepping_, standstill_, crowded_, shared_, instants_, arc_);
  if (meter_) meter_->forget();
}

/// The step that was only looked at, next to a singular pose.
void EventDriven::note_lead() {
  std::swap(now_, trial_);
  elapsed_ += lead_;
  note_arc(elapsed_ - lead_);
  elapsed_ -= lead_;
  std::swap(now_, trial_);
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

/// One accepted step, to the time `end` after the start at most, and the event at its end if there is one. last:
/// nothing ends there but the call.
bool EventDriven::advance(Solver& solver, double end, bool last, StepReport& report) {
  const double rest = end - elapsed_;
  stop_ = last ? kInf : std::nextafter(start_ + end, -kInf);
  if (!(h_ > 0)) h_ = first_guess(rest);
  double s = std::min(h_, rest);
  const auto rejected = report.rejected;
  if (!motion_.lasting().empty()) {
    set_poses(system_, start_ + elapsed_, now_.q, poses_);
    s = std::min(s, horizon(system_, motion_.lasting(), poses_, now_.v, now_.a));
  }
  for (;;) {
    const double error = error_of_step(s),
                 factor = std::clamp(0.9 * std::pow(error, -1 / DormandPrince::kErrorOrder), 0.2, 6.0);
    if (error <= 1) {
      h_ = s < h_ ? std::max(h_, factor * s) : factor * s;
      report.error_estimate += error * q_scale_.maxCoeff();
      break;
    }
    if (error < kInf && turns(s) && find_turn(s)) return turn(solver, s, end, report);
    if (report.rejected == rejected) measure_noise();
    ++report.rejected;
    h_ = s *= error < kInf ? factor : 0.1;
    if (s < 1e-3 * kRounding * (std::abs(start_) + elapsed_) + 1e-30)
      return fail(report, Status::stalled,
                  "step size below rounding at t = " + detail::text_of(start_ + elapsed_) +
                      ": the forces grow without bound, or tolerances are too small") ||
             (options_.go_on && cross(solver, end, report));
  }
  if (rank_ < system_.joint_rows() && least_independence_ < kUntold)
    return fail(report, Status::numerical_error,
                "redundant joints next to a singular pose at t = " + detail::text_of(start_ + elapsed_) +
                    ": the branch cannot be determined; use adaptive or an integrator of fixed step") ||
           (options_.go_on && cross(solver, end, report));
  const bool early = pass_over(s, rest);
  std::optional<Sign> event;
  for (int i = 0;; ++i) {
    if (i == kLandings)
      return fail(report, Status::stalled,
                  "no first event was found in " + std::to_string(kLandings) +
                      " tries at t = " + detail::text_of(start_ + elapsed_)) ||
             (options_.go_on && cross(solver, end, report));
    const std::optional<Sign> next = first_sign(s);
    if (!next) break;
    const double before = s;
    event.reset();
    if (land(*next, s)) event = next;
    if (!(s < before)) break;  // rounding: found again where the step ends already
  }
  ++report.accepted;
  if (early && last && !event && motion_.lasting().empty()) return hand_out(rest);
  ++flight_, flight_time_ += s;
  accept(s, end);
  if (crowded_ > (elapsed_ - crossed_ < kSoon * crossing_ ? kShortSteps / 4 : kShortSteps))
    return fail(report, Status::stalled, "events repeat without end at t = " + detail::text_of(start_ + elapsed_)) ||
           cross(solver, end, report);
  return !event || change_modes(solver, event, report) ||
         ((no_answer_ || options_.go_on) && cross(solver, end, report));
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

/// What rounding of the coordinates makes of the accelerations at now_: no step is held to less. Far from the origin
/// that is much where a contact's normal hangs on a small clearance.
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
bool EventDriven::hand_out(double s) {
  lead_ = s;
  for (const double part : {8, 7, 9}) {
    if (least_independence_ >= kNearest) return true;
    const double aside = s / part;
    if (!try_step(s - aside) || least_independence_ < kBlurred) continue;
    std::swap(earlier_, trial_);
    if (!try_step(s + aside) || least_independence_ < kBlurred) continue;
    interpolate(earlier_, trial_, 2 * aside, 0.5, middle_);
    middle_.v = 15 / (16 * aside) * between(earlier_.q, trial_.q) - 7.0 / 16 * (earlier_.v + trial_.v) +
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
  const bool close = s * largest_rotation(now_.v) < kSmallTurn;
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
  trial_residual_ = motion_.project(end, trial_.q, trial_.v);
  if (trial_residual_.changed && least_independence_ < kSingular) return false;
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

/// Shortens the step to where contacts turn: released_. The last stages of a step across that place see the other
/// normal, so its velocity and forces are those of the longest step that ends before it. It goes on from somewhat
/// behind the place, where rounding does not choose the normal. False: what happens sooner has to be looked at first.
bool EventDriven::find_turn(double& s) {
  double low = 0, high = s;
  const auto instant = [&] { return kShortest * kRounding * (std::abs(start_) + elapsed_ + high); };
  while (high - low > instant()) {
    s = (low + high) / 2;
    if (!try_step(s)) return false;
    (turns(s) ? high : low) = s;
  }
  if (!try_step(s = high) || !turns(s)) return false;
  for (std::size_t i = 0; i < motion_.lasting().size(); ++i) turned_[at(motion_.lasting()[i])] = turned(i, s);
  if (low > 0) {
    if (!(error_of_step(low) <= 1) || first_sign(low)) return false;
  } else {
    trial_ = now_, trial_residual_ = residual_;
    std::fill(push_.begin(), push_.end(), Impulse{});
  }
  double behind = high - low;
  for (const int c : motion_.lasting()) {
    if (!turned_[at(c)]) continue;
    const double speed = std::abs(trial_.w.slip[c] + system_.law(c).belt);
    behind = std::max(behind, std::min(kBehind * gap_zero(c) / speed, kCrowded * options_.crossing));
  }
  move(trial_.q, behind * trial_.v);
  s = low + behind;
  return true;
}

/// Takes the trial step, at the end of which contacts have turned: they are let go, and what follows is decided again.
bool EventDriven::turn(Solver& solver, double s, double end, StepReport& report) {
  released_.assign(turned_.begin(), turned_.end());
  accept(s, end);
  ++report.accepted, h_ = 0;
  for (int c = 0; c < system_.contacts(); ++c) {
    if (!released_[at(c)]) continue;
    motion_.modes[at(c)] = {};
    events_.push_back({start_ + elapsed_, EventKind::release, c, 0, 0});
  }
  motion_.modes_changed();
  residual_ = motion_.project(start_ + elapsed_, now_.q, now_.v);
  if (!observe(now_, start_ + elapsed_)) return fail(report, Status::numerical_error, "no accelerations");
  return change_modes(solver, {}, report) || ((no_answer_ || options_.go_on) && cross(solver, end, report));
}

double EventDriven::slack(const Sign& sign) const {
  if (sign.watch == Watch::approach) return 2 * speed_zero(now_.w.gap_rate_scale[sign.contact]);
  return sign.watch == Watch::gap ? 2 * gap_zero(sign.contact) : watch_.slack(sign);
}

/// The event function; ≥ 0 before the event.
double EventDriven::value(const Sign& sign, const Watched& w) const {
  if (sign.watch != Watch::gap) return watch_.value(sign, w);
  if (overlaps(sign.contact)) return -w.gap[sign.contact];
  return w.gap[sign.contact] - std::min(0.0, now_.w.gap[sign.contact]);
}

/// Whether no force at now_ moves the contact, and the joints' drives do not press it shut.
bool EventDriven::immobile(int contact) {
  if (system_.joint_rows() == 0 || !immobility_.stand(start_ + elapsed_, now_.q)) return false;
  const Immobility::Verdict verdict = immobility_.look(immobility_.rows(contact).normal);
  return verdict.immobile && verdict.rate >= 0;
}

/// Whether the contact is closed, to rounding, and does not move in the trial step.
bool EventDriven::stands(int c, double s) const {
  const auto closed = [&](const Point& p) {
    return stays(p.w.gap[c], c) && s * std::abs(p.w.gap_rate[c]) <= kStays * gap_zero(c) + options_.touching;
  };
  return closed(now_) && closed(trial_);
}

std::optional<Sign> EventDriven::first_sign(double s) {
  std::optional<Sign> first;
  if (s <= 0) return first;
  if (!motion_.lasting().empty() && watch_.look(start_ + elapsed_, s, now_, trial_, stop_)) first = watch_.first();
  sweep_.begin(start_ + elapsed_, s, now_, trial_);
  const auto sample = [](const Watched& w, int c) -> ContinuousCollision::Sample {
    return {w.gap[c], w.gap_rate[c], w.gap_acceleration[c]};
  };
  for (int c = 0; c < system_.contacts(); ++c) {
    if (motion_.modes[at(c)].lasting) continue;
    if (stands(c, s)) continue;
    const auto found =
        overlaps(c) ? end_of_overlap(c, s) : sweep_.first(c, sample(now_.w, c), sample(trial_.w, c), 2 * gap_zero(c));
    if (!found || (first && first->crossing.x <= found->crossing.x)) continue;
    if (stays(now_.w.gap[c], c) && stays(trial_.w.gap[c], c) && immobile(c))
      continue;  // rounding of what the joints hold
    first = found;
  }
  return first;
}

/// Shortens the step to where the function is zero. False: it is not there, it only came near; s is shortened all the
/// same.
bool EventDriven::land(const Sign& sign, double& s) {
  const double tiny = slack(sign) / 2;
  double low = sign.low * s, high = sign.high * s, last_x = 0, last = 0;
  double x = sign.crossing.x * s, slope = sign.crossing.slope / s;
  bool bracketed = sign.high == 1 && value(sign, trial_.w) < 0;
  for (int i = 0; i < 80; ++i) {
    if (!try_step(x)) break;
    s = x;
    const double f = value(sign, trial_.w);
    if (sign.watch == Watch::gap)
      slope = overlaps(sign.contact) ? -trial_.w.gap_rate[sign.contact] : trial_.w.gap_rate[sign.contact];
    else if (sign.watch == Watch::approach)
      slope = trial_.w.gap_acceleration[sign.contact];
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
    if (std::abs(next - x) <= kRounding * x) break;
    x = next;
  }
  // A gap that jumps: it is closed behind the jump.
  const bool narrow = high - s <= kInstant * kRounding * (std::abs(start_) + elapsed_ + s);
  if (sign.watch == Watch::gap && bracketed && narrow && value(sign, trial_.w) > slack(sign) && try_step(high))
    s = high;
  return true;
}

void EventDriven::accept(double s, double end) {
  const double before = elapsed_;
  load_ = std::max(load_, now_.w.normal.size() > 0 ? now_.w.normal.maxCoeff() : 0);
  if (meter_) work_ += meter_->over_motion(start_ + elapsed_, s, now_, trial_, motion_.modes);
  std::swap(now_, trial_);
  residual_ = trial_residual_;
  elapsed_ = s < end - elapsed_ ? elapsed_ + s : end;
  standstill_ = elapsed_ > before ? 0 : standstill_ + 1;
  const double moved = s * now_.v.lpNorm<Eigen::Infinity>();
  const bool crowd =
      s < kCrowded * options_.crossing && moved <= kNowhere * std::max(size_, now_.q.lpNorm<Eigen::Infinity>());
  crowded_ = crowd ? crowded_ + 1 : 0, shared_ = crowd ? shared_ : 0;
  for (const int c : motion_.lasting())
    impulses_[at(c)].normal += s * push_[at(c)].normal, impulses_[at(c)].tangent += s * push_[at(c)].tangent;
  if (striding_) note_arc(before);
}

/// Of the step just accepted, from `before` after the call's start.
void EventDriven::note_arc(double before) {
  arc_.start = start_ + before, arc_.length = elapsed_ - before;
  arc_.q0 = trial_.q, arc_.v0 = trial_.v, arc_.a0 = trial_.a;
  arc_.q1 = now_.q, arc_.v1 = now_.v, arc_.a1 = now_.a;
  arc_.modes = motion_.modes;
  arc_.push = impulses_;
}

}  // namespace orthant
