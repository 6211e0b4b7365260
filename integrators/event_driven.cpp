#include <orthant/core/support/options.h>
#include <orthant/integrators/event_driven.h>
#include <orthant/integrators/horizon.h>
#include <orthant/solvers/enumerate.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kForceZero =
    1e-8;                           // of the largest force: contacts this near to opening or sliding off do so together
constexpr double kUntold = 1e-4;    // independence, of joints that are redundant anyway, of poses not to be passed
constexpr double kSingular = 1e-2;  // independence of the joint rows below which a pose counts as next to singular
constexpr double kNearest = 1e-4;   // likewise: a state is better found from both sides
constexpr double kBlurred = 1e-6;   // likewise: but not from steps with a stage as near as this
constexpr double kTurned = 1e-7;    // of the speeds that make up a gap's rate: its normal has jumped
constexpr double kInstant = 8;      // roundings of the time: no shorter step tells when
constexpr double kMuch = 1e9;       // more of an error than any step is allowed
constexpr double kFewStages = 0.467;  // of a step: the widest interval without a stage of the method is around it
constexpr double kSmallTurn = 0.1;    // [rad] of a body in a step whose stages are near enough to project them there
constexpr double kPressed = 1e-6;     // of the accelerations: a contact let go that comes back faster does not open
constexpr double kLongestCrossing = 1e-4;  // [s]
constexpr double kTilt = 1e-9;             // [m] deeper overlaps are no rounding
constexpr int kShortSteps = 15;            // steps in a row, each shorter than
constexpr int kShares = 200;               // times that friction is shared anew in such a row, which count for no event
constexpr double kSoon = 50;               // crossings: no calm has come since the last one
constexpr double kCrowded = 1e-4;          // of a crossing: events are taken to have no end

/// Whether none of all combinations of a few contacts solves the impact, not even a little slower, so that nothing hangs on
/// rounding: friction and restitution contradict each other. Impulses that lose all digits solve nothing.
bool contradictory(Lcp impact) {
  constexpr Index kFewRows = 12;
  constexpr double kSlack = 1e-8, kLost = 1e12;  // of the fastest rate; likewise, what one impulse does
  if (impact.size() == 0 || impact.size() > kFewRows || !finite(impact)) return false;
  const double fastest = impact.b.lpNorm<Eigen::Infinity>();
  impact.b += (impact.lo.array() == 0).select(kSlack * fastest, Vector::Zero(impact.size()));
  Vector diag;
  diagonal(impact.A, diag);
  const auto solves = [&](const Vector& z) { return (diag.array() * z.array()).abs().maxCoeff() <= kLost * fastest; };
  const SolutionSet set = enumerate_solutions(impact);
  return std::none_of(set.isolated.begin(), set.isolated.end(), solves) &&
         std::all_of(set.faces.begin(), set.faces.end(), [&](const SolutionFace& face) {
           return std::none_of(face.vertices.begin(), face.vertices.end(), solves);
         });
}

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

/// At now_: impacts, then the modes; their events.
bool EventDriven::change_modes(Solver& solver, const std::optional<Sign>& event, StepReport& report) {
  const double t = start_ + elapsed_;
  if (++instants_ > options_.max_events)
    return fail(report, Status::iteration_limit, "max_events are used up at t = " + detail::text_of(t));
  if (event && standstill_ == 0 && shares_anew(*event)) {
    if (++shared_ < kShares) crowded_ = std::max(0, crowded_ - 1);  // no event of a crowd, unless it goes on so
    return true;
  }
  no_answer_ = false;
  before_ = motion_.modes;
  std::fill(released_.begin(), released_.end(), false);
  std::fill(slides_.begin(), slides_.end(), 0.0);
  std::fill(held_.begin(), held_.end(), false);
  for (Bounces& b : bounces_) b.over = false;
  int struck = 0;
  // What would touch at once in exact arithmetic has come apart by the rounding of the steps since the last event, and of
  // the velocities that it left.
  const double tie = 16 + 64.0 * flight_, since = flight_time_;
  flight_ = 0, flight_time_ = 0;
  for (int c = 0; c < system_.contacts(); ++c) {
    const ContactMode& mode = motion_.modes[at(c)];
    const bool hit = event && event->watch == Watch::gap && event->contact == c;
    touching_[at(c)] =
        hit || mode.lasting ||
        now_.w.gap[c] <= tie * gap_zero(c) + options_.touching + since * kSame * now_.w.gap_rate_scale[c];
    if (!touching_[at(c)] || mode.lasting || now_.w.gap_rate[c] >= -speed_zero(now_.w.gap_rate_scale[c])) continue;
    ++struck;
    note_bounce(c);
  }
  if (struck > 1) close_together();
  if (struck > 0 && !impact(solver, accumulates(), report)) return false;
  return settle(solver, event, struck > 0, report);
}

/// Contacts that strike together get the gap 0: a tilt that rounding made would grow from impact to impact.
void EventDriven::close_together() {
  for (std::size_t c = 0; c < touching_.size(); ++c)
    motion_.modes[c].lasting = touching_[c] && now_.w.gap[static_cast<Index>(c)] > -kTilt;
  motion_.modes_changed();
  stage_q_ = now_.q, stage_v_ = now_.v;
  if (motion_.project(start_ + elapsed_, stage_q_, stage_v_).joint < kInf) now_.q = stage_q_;
  motion_.modes = before_;
  motion_.modes_changed();
}

bool EventDriven::impact(Solver& solver, bool plastic, StepReport& report) {
  Terms& terms = motion_.terms();
  if (!motion_.accelerations(start_ + elapsed_, now_.q, now_.v, now_.a))
    return fail(report, Status::numerical_error, "no accelerations at an impact");
  struck_.clear();
  for (int c = 0; c < system_.contacts(); ++c)
    if (plastic ? bounces_[at(c)].over || motion_.modes[at(c)].lasting : touching_[at(c)]) struck_.push_back(c);
  evaluate_closed(system_, struck_, terms);
  // Residues of earlier contacts (1e-300 has been seen) would only trouble the solvers.
  now_.v = (now_.v.array().abs() < 1e-20 * now_.v.lpNorm<Eigen::Infinity>()).select(0, now_.v);
  newtons_law(system_.laws(), terms, now_.v, wanted_);
  restrict_to_strikes(wanted_);
  stage_v_ = now_.v;
  problem_ = &impact_.problem();
  const bool in_turn = plastic && ends_in_turn();
  if (in_turn)
    no_answer_ = !impact_.strike_in_turn(terms, motion_.basic(), in_turn_, now_.v, solver, report);
  else if (!plastic)
    no_answer_ = !impact_.strike(terms, motion_.basic(), stage_v_, wanted_, now_.v, solver, report);
  if (no_answer_) return fail(report, report.status, impact_.why());
  if (in_turn) newtons_law(system_.laws(), terms, now_.v, wanted_), restrict_to_strikes(wanted_);
  if (plastic)
    for (Wanted& wanted : wanted_) wanted.normal = 0;
  formulation_.formulate(terms, motion_.basic(), wanted_, now_.v, none_);
  problem_ = &formulation_.problem();
  no_answer_ = !formulation_.solve(solver, report);
  if (no_answer_) {
    const bool none = contradictory(formulation_.problem());
    return fail(
        report, none ? Status::infeasible : report.status,
        none ? "Newton's law of impact has no solution here: friction and restitution contradict each other (jamming)"
             : "the impact was not solved");
  }
  formulation_.advance(now_.v, hit_);
  if (in_turn || !plastic) impact_.add_to(hit_);
  report.energy_rise = std::max(report.energy_rise, energy_rise(system_, terms, wanted_, now_.v, hit_));
  const double t = start_ + elapsed_;
  for (const ClosedContact& closed : terms.closed) {
    const int c = closed.contact;
    const Impulse& hit = hit_[at(c)];
    impulses_[at(c)].normal += hit.normal, impulses_[at(c)].tangent += hit.tangent;
    if (plastic && bounces_[at(c)].over)
      events_.push_back({t + bounces_[at(c)].rest, EventKind::accumulation, c, hit.normal, hit.tangent});
    else if (hit.normal > 0)
      events_.push_back({t, EventKind::impact, c, hit.normal, hit.tangent});
  }
  return true;
}

/// Before an impact at contact c.
void EventDriven::note_bounce(int c) {
  Bounces& b = bounces_[at(c)];
  b.add(start_ + elapsed_);
  const double height = -now_.w.gap_rate[c] * b.interval / 4;  // of the last one, a parabola of this speed
  b.height = height * b.ratio;
  b.rounding = height <= 16 * gap_zero(c);
}

/// Whether another contact struck since this one last did, and its bounces are still resolved: they end together.
template <class Low> bool EventDriven::waits(const Bounces& ending, const Low& low) const {
  for (int c = 0; c < system_.contacts(); ++c) {
    const Bounces& b = bounces_[at(c)];
    const bool between = b.last < ending.last && b.last > ending.last - ending.interval;
    if (between && !motion_.modes[at(c)].lasting && !(b.accumulates() && now_.w.gap[c] <= low(c))) return true;
  }
  return false;
}

/// Marks the contacts whose bounces need not be resolved any more, if there are any at this time.
bool EventDriven::accumulates() {
  const double t = start_ + elapsed_;
  const auto low = [&](int c) { return std::max(options_.accumulation, 32 * gap_zero(c)); };
  bool any = false;
  for (int c = 0; c < system_.contacts(); ++c) {
    const Bounces& b = bounces_[at(c)];
    any = any || (b.last == t && (b.rounding || (b.accumulates() && b.height <= low(c) && !waits(b, low))));
  }
  for (int c = 0; c < system_.contacts(); ++c) {
    Bounces& b = bounces_[at(c)];
    b.over = any && (b.rounding || b.accumulates()) && t - b.last <= b.interval && now_.w.gap[c] <= low(c);
    touching_[at(c)] = touching_[at(c)] || b.over;
  }
  return any;
}

/// Whether several of the series that are over had their impacts in turn: in_turn_.
bool EventDriven::ends_in_turn() {
  double first = kInf, last = -kInf, interval = kInf;
  for (std::size_t c = 0; c < in_turn_.size(); ++c) {
    const Bounces& b = bounces_[c];
    in_turn_[c] = b.over && !motion_.modes[c].lasting;
    if (!in_turn_[c]) continue;
    first = std::min(first, b.last), last = std::max(last, b.last), interval = std::min(interval, b.interval);
  }
  return last - first > kInTurn * interval;
}

/// Where events have no end, or an instant no answer that could be computed: a step of Moreau–Jean's method. What it
/// leaves no faster than it falls within the step lasts. Where that does not help either the next one is twice as long.
bool EventDriven::cross(Solver& solver, double end, StepReport& report) {
  const Status status = report.status;
  const std::string words = why_;
  for (bool calm = false; !calm;) {
    crossing_ = elapsed_ - crossed_ < kSoon * crossing_ ? std::min(2 * crossing_, kLongestCrossing) : options_.crossing;
    const double s = std::min(crossing_, end - elapsed_);
    if (!(s > 0)) return fail(report, status, words);
    crossing_state_.t = start_ + elapsed_, crossing_state_.q = now_.q, crossing_state_.v = now_.v;
    const StepReport step = stepping_.step(s, solver, crossing_state_);
    report.lcp_solves += step.lcp_solves, report.lcp_iterations += step.lcp_iterations, ++report.accepted;
    if (step.status != Status::solved) return fail(report, status, words);
    now_.q = crossing_state_.q, now_.v = crossing_state_.v;
    elapsed_ = s < end - elapsed_ ? elapsed_ + s : end;
    crossed_ = elapsed_, standstill_ = crowded_ = shared_ = flight_ = 0, flight_time_ = 0;
    std::fill(motion_.modes.begin(), motion_.modes.end(), ContactMode{});
    motion_.modes_changed();
    if (!observe(now_, start_ + elapsed_)) return fail(report, Status::numerical_error, "no accelerations");
    const double slow = s * now_.a.lpNorm<Eigen::Infinity>();
    bool any = false;
    for (int c = 0; c < system_.contacts(); ++c) {
      const Impulse& push = stepping_.impulses()[at(c)];
      impulses_[at(c)].normal += push.normal, impulses_[at(c)].tangent += push.tangent;
      bounces_[at(c)] = {};
      touching_[at(c)] = bounces_[at(c)].over = push.normal > 0 && now_.w.gap_rate[c] <= slow;
      any = any || bounces_[at(c)].over;
    }
    std::fill(released_.begin(), released_.end(), false);
    std::fill(slides_.begin(), slides_.end(), 0.0);
    std::fill(held_.begin(), held_.end(), false);
    no_answer_ = false;
    calm = (!any || impact(solver, true, report)) && settle(solver, {}, true, report);
    if (!calm && !no_answer_) return false;
    if (calm) why_.clear(), report.status = Status::solved;
  }
  return true;
}

/// The modes at now_, after an impact or an event of the motion.
bool EventDriven::settle(Solver& solver, const std::optional<Sign>& event, bool struck, StepReport& report) {
  const double t = start_ + elapsed_;
  if (event && !struck) let_go(*event);
  const auto open_all = [&] {
    std::fill(motion_.modes.begin(), motion_.modes.end(), ContactMode{});
    motion_.modes_changed();
    return observe(now_, t);
  };
  for (bool again = true; again;) {
    if (!open_all()) return fail(report, Status::numerical_error, "no accelerations after an event");
    gather_candidates();
    const Status status = transition_.decide(motion_, solver, report);
    if (status != Status::solved) {
      problem_ = &transition_.problem();
      no_answer_ = transition_.undecided();
      return fail(report, status, transition_.why() + ", at t = " + detail::text_of(t));
    }
    residual_ = motion_.project(t, now_.q, now_.v);
    if (!observe(now_, t)) return fail(report, Status::numerical_error, "no accelerations after an event");
    again = false;
    for (int c = 0; c < system_.contacts(); ++c)
      if (released_[at(c)] && now_.w.gap_acceleration[c] < -kPressed * now_.a.lpNorm<Eigen::Infinity>())
        released_[at(c)] = false, again = true;  // pressed back by what else changes here
      else if (held_[at(c)] &&
               slides_[at(c)] * now_.w.slip_acceleration[c] < -kPressed * now_.a.lpNorm<Eigen::Infinity>())
        held_[at(c)] = false, slides_[at(c)] = 0, again = true;
  }
  load_ = 0, noise_.setZero();
  note_changes(event.has_value() && !struck);
  return true;
}

/// Contacts that share a force do so in the proportion of the normal forces when their modes were decided. One that comes
/// to the bound of friction by that alone sticks on when it is shared as the normal forces are now.
bool EventDriven::shares_anew(const Sign& event) {
  if (event.watch != Watch::cone_up && event.watch != Watch::cone_down) return false;
  motion_.share_anew(now_.w);
  return observe(now_, start_ + elapsed_) && room(event.contact) > slack(event);
}

/// What is "at the same time" in forces [N]. When events repeat at one time it is no better known than that.
double EventDriven::force_zero() const { return kForceZero * (1 + 1e3 * standstill_) * load_; }

double EventDriven::room(int contact) const {
  return static_mu(system_.law(contact)) * now_.w.normal[contact] - std::abs(now_.w.tangent[contact]);
}

/// Which contacts open (released_) or slide off (slides_) because their force has come to its end.
void EventDriven::let_go(const Sign& event) {
  if (event.watch == Watch::gap || event.watch == Watch::slip) return;
  const Watched& w = now_.w;
  const double zero = force_zero();
  for (const int c : motion_.lasting()) {
    if (event.watch == Watch::force) {
      released_[at(c)] = c == event.contact || w.normal[c] <= zero;
    } else if (before_[at(c)].slip != 0 && std::abs(w.slip[c]) <= speed_zero(w.slip_scale[c])) {
      held_[at(c)] = true, slides_[at(c)] = before_[at(c)].slip;  // at its bound while others hold it: let it be
    } else if (before_[at(c)].sticks) {
      if (c == event.contact || room(c) <= zero) slides_[at(c)] = w.tangent[c] > 0 ? -1 : 1;
    }
  }
}

/// Contacts that touch and neither separate nor were let go.
void EventDriven::gather_candidates() {
  transition_.candidates.clear();
  const Watched& w = now_.w;
  for (int c = 0; c < system_.contacts(); ++c) {
    if (!touching_[at(c)] || released_[at(c)]) continue;
    if (w.gap_rate[c] > speed_zero(w.gap_rate_scale[c]) && !bounces_[at(c)].over) continue;
    double slip = 0;
    if (system_.law(c).frictional())
      slip = std::abs(w.slip[c]) <= speed_zero(w.slip_scale[c]) ? slides_[at(c)] : w.slip[c] > 0 ? 1 : -1;
    transition_.candidates.push_back({c, slip});
  }
}

void EventDriven::note_changes(bool touched) {
  for (int c = 0; c < system_.contacts(); ++c) {
    const ContactMode &old = before_[at(c)], &mode = motion_.modes[at(c)];
    if (old == mode) continue;
    const auto emit = [&](EventKind kind) { events_.push_back({start_ + elapsed_, kind, c, 0, 0}); };
    if (!mode.lasting)
      emit(EventKind::release);
    else if (old.lasting)
      emit(mode.sticks ? EventKind::stick : EventKind::slip);
    else if (touched)
      emit(EventKind::touch);
  }
}

}  // namespace orthant
