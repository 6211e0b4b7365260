#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive/spatial_adaptive.h>
#include <orthant/integrators/between_events/first_crossing.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kInnerShare = 1e-3;           // of the tolerance, for an inner step
constexpr double kLongestSwing = 3;            // [rad]
constexpr double kLongestTurn = 1.5;           // [rad] of a body in an inner step
constexpr double kTurnOfNode = 0.25;           // [rad] of a contact's rows between two looks at its gap
constexpr int kMostNodes = 64, kHalvings = 6;  // looks at gaps in a step; further halvings
constexpr double kCubicError = 4e-5;           // of what a contact moves between two looks
constexpr double kStable = 0.5;                // of the time in which the direction of slip returns: a step
constexpr double kTurnShare = 0.01;            // of rtol: of speeds, and of what friction makes in a second
constexpr double kStopShare = 0.95;            // of the time until slip stops
constexpr double kForceRounding = 1e-11;       // of the largest force
constexpr int kShortInARow = 15, kMostTries = 200;
constexpr double kShortStep = 1e-10;  // [s]

/// Of the lasting contacts, three numbers a contact of the scene.
template <class Forces> void forces_to(const SpatialMotion& motion, Forces&& to) {
  for (std::size_t i = 0; i < motion.lasting().size(); ++i) {
    const Index first = 3 * motion.lasting()[i];
    const Tangents tangent = motion.tangent_force(i);
    to[first] = motion.normal_force(i), to[first + 1] = tangent.first, to[first + 2] = tangent.second;
  }
}

double time_rounding(double t) { return 0x1p-49 * std::abs(t); }

}  // namespace

SpatialAdaptive::Point::Point(const System& system)
    : q(system.coordinates()),
      v(system.dof()),
      a(Eigen::VectorXd::Zero(system.dof())),
      w(system.contacts()),
      force(Eigen::VectorXd::Zero(3 * system.contacts() + 1)) {}

SpatialAdaptive::SpatialAdaptive(const System& system, const Options& options)
    : IntegratorOf<Spatial>(system, kName, kCan),
      options_(options),
      inner_{std::clamp(kInnerShare * options.rtol, 1e-13, 1e-4),
             std::clamp(kInnerShare * std::min(options.atol, options.rtol), 1e-14, 1e-4)},
      measures_(has_work(system)),
      motion_(system),
      between_(system),
      transition_(system),
      formulation_(system),
      impact_(system),
      rk_(system.dof()),
      stepping_(system, {}),
      now_(system),
      trial_(system),
      path_scale_(system.dof()),
      v_scale_(system.dof()),
      stage_force_(3 * system.contacts() + 1, dormand_prince::kAllStages),
      push_(Eigen::VectorXd::Zero(3 * system.contacts() + 1)),
      bounces_(impulses_.size()),
      touching_(impulses_.size()),
      released_(impulses_.size()),
      in_turn_(impulses_.size()),
      slides_(impulses_.size(), Vector3d::Zero()),
      struck_(impulses_.size()),
      none_(Eigen::VectorXd::Zero(system.dof())),
      handed_(system),
      shown_(&formulation_) {
  const auto refuse = [](const char* what) {
    throw std::invalid_argument("integrator " + std::string(kName) + ": takes no " + what +
                                " in space: must be moreau-jean or another integrator of fixed step");
  };
  if (!system.scene().collisions.empty()) refuse("searched collisions");
  if (!system.scene().frictions.empty()) refuse("dry friction in joints");
  if (system.swing() > 0) swing_ = kLongestSwing / system.swing();
  stride_.push = stride_.force = push_;
  left_.impulses.resize(impulses_.size());
  events_.reserve(64), left_.events.reserve(64);
}

void SpatialAdaptive::remember(CheckpointData& memory) {
  memory(time_, began_, reach_, next_, begun_, load_, now_.q, now_.v, stride_.start, stride_.a, stride_.force,
         stride_.modes, stride_.length, stride_.arc, stride_.push, left_.events, left_.impulses, left_.work,
         failed_.status, failed_.why, last_, crowd_.steps, crowd_.standstill, crowd_.length, crowd_.end, bounces_,
         motion_, between_, transition_, formulation_, impact_, stepping_);
  memory(now_.residual.joint, now_.residual.rate, now_.residual.off);
  fresh_ = stride_.fitted = false;
}

template <class Motion> auto SpatialAdaptive::acceleration_in(Motion& motion) {
  return [this, &motion](double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a) {
    t = std::min(t, stop_);
    if (!motion.accelerations(t, q, v, a)) return false;
    if (measures_) stage_power_ = motion.power(t, v, a);
    return true;
  };
}

// --- Calls ----------------------------------------------------------------------------------------------------------

bool SpatialAdaptive::goes_on(const State& x) const {
  return last_.q.size() == x.q.size() && std::abs(x.t - last_.t) <= time_rounding(x.t) && x.q == last_.q &&
         x.v == last_.v;
}

void SpatialAdaptive::restart(const State& x) {
  now_.q = x.q, now_.v = x.v;
  time_ = began_ = x.t, reach_ = 1, next_ = 0;
  begun_ = fresh_ = false;
  failed_ = {};
  left_.events.clear(), left_.work = 0;
  std::fill(left_.impulses.begin(), left_.impulses.end(), Impulse{});
  std::fill(bounces_.begin(), bounces_.end(), Bounces{});
  stride_.arc = false, stride_.length = 0;
  crowd_ = {};
}

StepReport SpatialAdaptive::step(double h, Solver& solver, State& x) {
  StepReport report = StepReport::solved(0);
  if (measures_) report.work = 0;
  why_.clear(), events_.clear();
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  formulation_.clear(), shown_ = &formulation_;
  if (!goes_on(x)) restart(x);
  const double target = x.t + h, rounding = time_rounding(target);
  if (time_ <= target + rounding) hand_over_all(report);
  while (time_ < target - rounding && failed_.status == Status::solved) {
    if (stopped(report)) break;
    if (report.accepted + report.rejected >= options_.max_steps) {
      fail(report, Status::iteration_limit, "max_steps used up at t = " + detail::text_of(time_) + " s");
      break;
    }
    stride(solver, report);
    if (time_ <= target + rounding) hand_over_all(report);
  }
  if (failed_.status != Status::solved && time_ <= target + rounding) {  // what the last inner step came to shows now
    fail(report, failed_.status, failed_.why);
    failed_ = {};
  }
  hand_out(target, x, report);
  last_ = x;
  return report;
}

/// Events, impulses and work of the last inner step, as far as they are still to be handed out.
void SpatialAdaptive::hand_over_all(StepReport& report) {
  if (measures_) *report.work += left_.work;
  left_.work = 0;
  events_.insert(events_.end(), left_.events.begin(), left_.events.end());
  left_.events.clear();
  for (std::size_t c = 0; c < impulses_.size(); ++c) {
    impulses_[c].normal += left_.impulses[c].normal, impulses_[c].tangent += left_.impulses[c].tangent;
    left_.impulses[c] = {};
  }
}

/// The state at the end of a call, or where the inner steps ended.
void SpatialAdaptive::hand_out(double target, State& x, StepReport& report) {
  if (time_ <= target + time_rounding(target)) {
    x.t = report.status == Status::solved ? target : time_, x.q = now_.q, x.v = now_.v;
    if (report.status == Status::solved) time_ = target;
    report.joint_residual = now_.residual.joint, report.joint_rate = now_.residual.rate;
  } else {
    hand_out_within(target, x, report);
  }
  if (gaps_.size() == 0) return;
  set_poses(system_, x.t, x.q, handed_.at);
  evaluate_gaps(system_, handed_);
  gaps_ = handed_.gap;
  report.penetration = std::max(0.0, -gaps_.minCoeff());
}

/// The method's continuous extension over the last arc. False: there is none.
bool SpatialAdaptive::fit() {
  between_.modes = stride_.modes, between_.modes_changed();
  if (!stride_.arc) return false;
  const State& from = stride_.start;
  stop_ = std::nextafter(from.t + stride_.length, -kInf);
  now_force_ = &stride_.force;
  bool fits = integrate(between_, from.t, from, stride_.a, stride_.length, q_within_, v_within_) &&
              rk_.extend(acceleration_in(between_), from.t, from.q, from.v, stride_.a, stride_.length, v_within_,
                         [&](std::size_t stage) { note_stage(between_, stage); });
  if (fits) extension_.fit(stride_.length, stride_.force, stage_force_, push_);
  stop_ = kInf;
  return fits;
}

/// At t within the last inner step: on the extension, or, within a crossing, on the straight line between its ends.
/// Impulses and work are those until then.
void SpatialAdaptive::hand_out_within(double t, State& x, StepReport& report) {
  const double s = t - stride_.start.t;
  const bool inside = stride_.arc && s <= stride_.length && (stride_.fitted || fit());
  stride_.fitted = inside;
  if (inside) {
    rk_.at(s / stride_.length, q_within_, v_within_);
    move<Spatial>(stride_.start.q, q_within_, x.q);
    x.v = stride_.start.v + v_within_;
  } else {
    between_.open_all();
    move<Spatial>(stride_.start.q, s / (time_ - stride_.start.t) * between<Spatial>(stride_.start.q, now_.q), x.q);
    x.v = now_.v;
  }
  x.t = t;
  q_within_ = x.q, v_within_ = x.v;
  const SpatialMotion::Residual left = between_.project(t, q_within_, v_within_);
  report.joint_residual = left.joint, report.joint_rate = left.rate;
  if (left.joint < kInf) x.q = q_within_, x.v = v_within_;
  const auto later = std::find_if(left_.events.begin(), left_.events.end(), [&](const Event& e) { return e.t > t; });
  events_.insert(events_.end(), left_.events.begin(), later);
  left_.events.erase(left_.events.begin(), later);
  if (!inside) return;
  extension_.at(s / stride_.length, push_);
  push_ -= stride_.push;
  for (const int c : between_.lasting()) {
    const auto i = static_cast<std::size_t>(c);
    double& normal = push_[3 * c];
    normal = std::clamp(normal, 0.0, std::max(0.0, left_.impulses[i].normal));
    const Tangents tangent{push_[3 * c + 1], push_[3 * c + 2]};
    impulses_[i].normal += normal, impulses_[i].tangent += tangent;
    left_.impulses[i].normal -= normal, left_.impulses[i].tangent += -1 * tangent;
  }
  if (measures_) *report.work += push_[push_.size() - 1], left_.work -= push_[push_.size() - 1];
  stride_.push += push_;
}

// --- Inner steps ----------------------------------------------------------------------------------------------------

bool SpatialAdaptive::give_up(Status status, std::string why) {
  failed_ = {status, std::move(why)};
  return false;
}

bool SpatialAdaptive::begin(Solver& solver, StepReport& report) {
  begun_ = true;
  motion_.open_all();
  motion_.rest(time_, now_.q, inner_.atol);
  now_.residual = motion_.project(time_, now_.q, now_.v);
  if (!observe(now_, time_)) return give_up(Status::numerical_error, "no accelerations at the start");
  return change(solver, {}, report) || cross(solver, report);
}

/// One inner step. False: it failed, and ends at time_.
bool SpatialAdaptive::stride(Solver& solver, StepReport& report) {
  stride_.arc = stride_.fitted = false, stride_.start = {time_, now_.q, now_.v}, stride_.length = 0;
  stride_.push.setZero();
  const double from = time_;
  stop_ = kInf;
  bool going = begun_ || begin(solver, report);
  if (going && !fresh_) going = observe(now_, time_) || give_up(Status::numerical_error, "no accelerations");
  if (going && time_ == from) {
    stride_.start = {time_, now_.q, now_.v};
    going = advance(solver, report);
  }
  if (time_ > from) reach_ = std::max(10 * (time_ - from), time_ - began_);
  if (going) report.status = Status::solved, why_.clear();
  return going;
}

/// Accelerations and all that is watched; p.q and p.v are given.
bool SpatialAdaptive::observe(Point& p, double t) {
  if (!motion_.accelerations(std::min(t, stop_), p.q, p.v, p.a)) return false;
  p.force.setZero();
  if (measures_) p.force[p.force.size() - 1] = motion_.power(std::min(t, stop_), p.v, p.a);
  motion_.watch(p.q, p.v, p.a, p.w);
  forces_to(motion_, p.force);
  if (&p == &now_) fresh_ = true;
  return true;
}

/// [s] that a step may have, at most.
double SpatialAdaptive::longest(double rest) const {
  double s = std::min({rest, reach_, swing_});
  const double turning = largest_rotation<Spatial>(now_.v);
  if (turning > 0) s = std::min(s, kLongestTurn / turning);
  for (int c = 0; c < system_.contacts(); ++c) {
    const SpatialMode& mode = motion_.modes[static_cast<std::size_t>(c)];
    const double pace = motion_.pace(c, now_.v);
    if (!mode.lasting) s = std::min(s, kMostNodes * kTurnOfNode / std::max(pace, 1e-300));
    if (!mode.slides || mode.departs || !(now_.w.slip_change[c] < 0) || now_.w.slip[c] <= slip_zero(now_)) continue;
    const double stops = -now_.w.slip[c] / now_.w.slip_change[c];
    if (s > kStopShare * stops) s = kStopShare * stops;
  }
  return s;
}

double SpatialAdaptive::first_guess() const {
  const double fast = std::max(now_.v.lpNorm<Eigen::Infinity>(), 1e-3);
  return std::clamp(0.1 * fast / std::max(now_.a.lpNorm<Eigen::Infinity>(), 1e-10), 1e-6, 1.0);
}

/// Forces and power of a stage that has just been evaluated.
void SpatialAdaptive::note_stage(const SpatialMotion& motion, std::size_t stage) {
  auto column = stage_force_.col(static_cast<Index>(stage));
  column.setZero();
  forces_to(motion, column);
  column[column.size() - 1] = stage_power_;
  column -= *now_force_;
}

/// A step of the method in the modes of `motion`, the impulses and the work in it to push_. *now_force_: those at its
/// start.
bool SpatialAdaptive::integrate(SpatialMotion& motion, double t, const State& from, const Eigen::VectorXd& a, double s,
                                Eigen::VectorXd& q, Eigen::VectorXd& v) {
  stage_power_ = 0;
  if (!rk_.step(acceleration_in(motion), t, from.q, from.v, a, s, q, v,
                [&](std::size_t stage) { note_stage(motion, stage); }))
    return false;
  push_ = *now_force_;
  for (std::size_t i = 1; i < dormand_prince::kStages; ++i)
    if (dormand_prince::kB[i] != 0) push_ += dormand_prince::kB[i] * stage_force_.col(static_cast<Index>(i));
  push_ *= s;
  return true;
}

/// A step of s to trial_: its error over the tolerance; infinity: there is none.
double SpatialAdaptive::attempt(double s) {
  now_force_ = &now_.force;
  if (!integrate(motion_, time_, stride_.start, now_.a, s, trial_.q, trial_.v)) return kInf;
  const auto [rtol, atol] = inner_;
  for (Index i = 0; i < system_.bodies(); ++i) {
    translation<Spatial>(path_scale_, i).setConstant(rtol * place_of<Spatial>(trial_.q, i).norm() + atol);
    rotation<Spatial>(path_scale_, i).setConstant(rtol + atol);
    translation<Spatial>(v_scale_, i)
        .setConstant(atol +
                     rtol * std::max(translation<Spatial>(now_.v, i).norm(), translation<Spatial>(trial_.v, i).norm()));
    rotation<Spatial>(v_scale_, i)
        .setConstant(atol +
                     rtol * std::max(rotation<Spatial>(now_.v, i).norm(), rotation<Spatial>(trial_.v, i).norm()));
  }
  const double error = rk_.error(s, path_scale_, v_scale_);
  if (!(error <= 1)) return std::isnan(error) ? kInf : error;
  path_ = rk_.path();
  trial_.residual = motion_.project(time_ + s, trial_.q, trial_.v);
  return trial_.residual.joint < kInf && observe(trial_, time_ + s) ? error : kInf;
}

/// Some contact's slip has gone through zero in the trial step.
bool SpatialAdaptive::turned() const {
  return std::ranges::any_of(motion_.lasting(), [&](int c) {
    const auto i = static_cast<std::size_t>(c);
    return motion_.modes[i].slides && now_.w.along[i].dot(trial_.w.along[i]) < 0 &&
           trial_.w.slip[c] > slip_zero(trial_) && now_.w.slip[c] > slip_zero(now_);
  });
}

/// [m/s] what the turn of a departing contact may leave out of its slip.
double SpatialAdaptive::left_out(std::size_t k) const {
  return inner_.atol + kTurnShare * options_.rtol * (now_.v.lpNorm<Eigen::Infinity>() + motion_.grip(k));
}

/// The trial step is too long for a departure: the turn in it counts.
bool SpatialAdaptive::overdue() const {
  for (std::size_t k = 0; k < motion_.lasting().size(); ++k) {
    const auto i = static_cast<std::size_t>(motion_.lasting()[k]);
    const SpatialMode& mode = motion_.modes[i];
    if (mode.departs && trial_.w.slip[motion_.lasting()[k]] * (trial_.w.along[i] - mode.departure).norm() > left_out(k))
      return true;
  }
  return false;
}

/// Contacts slide by their slip as soon as that is no longer stiff in the next step, or the turn that a departure
/// leaves out counts.
void SpatialAdaptive::end_departures() {
  bool any = false;
  for (std::size_t k = 0; k < motion_.lasting().size(); ++k) {
    const int c = motion_.lasting()[k];
    SpatialMode& mode = motion_.modes[static_cast<std::size_t>(c)];
    if (!mode.departs) continue;
    const double grip = motion_.grip(k), slip = now_.w.slip[c];
    const double turned = (now_.w.along[static_cast<std::size_t>(c)] - mode.departure).norm();
    const double counts = left_out(k) / 4;
    const bool grows = now_.w.slip_change[c] >= 0;
    if (slip <= slip_zero(now_) || (grows && slip < kStable * grip * next_ && slip * turned < counts)) continue;
    mode.departs = false, any = true;
  }
  if (any) fresh_ = false;
}

/// One accepted step, with the event at its end if there is one.
bool SpatialAdaptive::advance(Solver& solver, StepReport& report) {
  const double stop = system_.next_breakpoint(time_ + time_rounding(time_));
  const double rest = stop - time_;
  stop_ = std::nextafter(stop, -kInf);
  if (!(next_ > 0)) next_ = first_guess();
  double s = std::min(next_, longest(rest));
  double error = kInf;
  for (;;) {
    error = attempt(s);
    const double factor =
        error < kInf ? std::clamp(0.9 * std::pow(error, -1 / ChartRungeKutta::kErrorOrder), 0.2, 6.0) : 0.2;
    if (error <= 1 && !turned() && !overdue()) {
      next_ = s < next_ ? std::max(next_, factor * s) : factor * s;
      break;
    }
    ++report.rejected;
    next_ = s *= error <= 1 ? 0.3 : factor;
    if (s < 1e-3 * time_rounding(time_) + 1e-30 || report.rejected >= options_.max_steps) {
      give_up(Status::stalled, "step size below rounding at t = " + detail::text_of(time_) +
                                   ": the forces grow without bound, or tolerances are too small");
      return cross(solver, report);
    }
  }
  std::optional<Sign> event;
  for (int i = 0;; ++i) {
    const std::optional<Sign> next = first_sign(s);
    if (!next) break;
    if (i == kMostTries) {
      give_up(Status::stalled, "no first event was found at t = " + detail::text_of(time_));
      return cross(solver, report);
    }
    const double before = s;
    event.reset();
    if (land(*next, s)) event = next;
    if (!(s < before)) break;
  }
  ++report.accepted;
  report.error_estimate += error * path_scale_.maxCoeff();
  accept(s, s >= rest, stop);
  if (s >= rest) {  // a force or its slope jumps
    stop_ = kInf;
    if (!observe(now_, time_)) return give_up(Status::numerical_error, "no accelerations");
    return change(solver, event, report) || cross(solver, report);
  }
  if (crowd_.steps > (time_ - crowd_.end < 50 * crowd_.length ? kShortInARow / 4 : kShortInARow)) {
    give_up(Status::stalled, "events repeat without end at t = " + detail::text_of(time_));
    return cross(solver, report);
  }
  if (!event) return end_departures(), true;
  return change(solver, event, report) || cross(solver, report);
}

/// Takes the trial step.
void SpatialAdaptive::accept(double s, bool at_stop, double stop) {
  stride_.arc = true, stride_.length = s, stride_.a = now_.a, stride_.force = now_.force;
  stride_.modes = motion_.modes;
  for (const int c : motion_.lasting()) load_ = std::max(load_, now_.w.normal[c]);
  std::swap(now_, trial_);
  const double before = time_;
  time_ = at_stop ? stop : time_ + s;
  crowd_.steps = s < kShortStep ? crowd_.steps + 1 : 0;
  crowd_.standstill = time_ > before ? 0 : crowd_.standstill + 1;
  for (const int c : motion_.lasting()) {
    Impulse& left = left_.impulses[static_cast<std::size_t>(c)];
    left.normal += push_[3 * c], left.tangent += Tangents{push_[3 * c + 1], push_[3 * c + 2]};
  }
  if (measures_) left_.work += push_[push_.size() - 1];
  motion_.forget_overlaps(now_.w);
}

// --- Events within a step -------------------------------------------------------------------------------------------

double SpatialAdaptive::room(int contact, const Point& p) const {
  return static_friction(system_.law(contact)) * p.w.normal[contact] - p.w.tangent[contact];
}

double SpatialAdaptive::value(const Sign& sign, const Point& p) const {
  switch (sign.watch) {
    case Watch::gap:
      return p.w.gap[sign.contact];
    case Watch::force:
      return p.w.normal[sign.contact];
    case Watch::cone:
      return room(sign.contact, p);
    case Watch::stop:
      break;
  }
  return p.w.slip[sign.contact];
}

/// Values this far below zero are zero.
double SpatialAdaptive::slack(const Sign& sign) const {
  if (sign.watch == Watch::gap) return 32 * gap_zero(sign.contact) + std::max(0.0, -now_.w.gap[sign.contact]);
  return kForceRounding * (load_ + now_.w.normal.lpNorm<Eigen::Infinity>());
}

/// The first event in the trial step of s.
std::optional<SpatialAdaptive::Sign> SpatialAdaptive::first_sign(double s) {
  std::optional<Sign> first;
  const bool open = static_cast<int>(motion_.lasting().size()) < system_.contacts();
  if (open || !motion_.lasting().empty()) {
    ChartRungeKutta::rate(path_, trial_.v, path_rate_);
    // φ'' at the end: J⁻¹ a + (J⁻¹)' v by central differences
    constexpr double kBeside = 1e-5;
    Eigen::VectorXd ahead, behind;
    const double by = kBeside / std::max(1e-3, largest_rotation<Spatial>(path_rate_));
    ChartRungeKutta::rate(path_ + by * path_rate_, trial_.v, ahead);
    ChartRungeKutta::rate(path_ - by * path_rate_, trial_.v, behind);
    ChartRungeKutta::rate(path_, trial_.a, path_bend_);
    path_bend_ += (ahead - behind) / (2 * by);
  }
  if (open) find_gaps(s, first);
  if (!motion_.lasting().empty()) find_ends(s, first);
  if (first) return first;
  for (const int c : motion_.lasting())
    if (motion_.modes[static_cast<std::size_t>(c)].slides && trial_.w.slip[c] <= slip_zero(trial_) &&
        trial_.w.slip[c] < now_.w.slip[c])
      return Sign{Watch::stop, c, 1};
  return {};
}

/// q and v at x ∈ [0, 1] of the trial step: the quintic Hermite polynomial of the chart, and the cubic one of v.
void SpatialAdaptive::between_ends(double s, double x, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  const double xx = x * x;
  hermite_.resize(path_.size()), v.resize(path_.size());
  for (Index i = 0; i < path_.size(); ++i) {
    const double d = path_[i] - s * (now_.v[i] + s / 2 * now_.a[i]),
                 e = s * (path_rate_[i] - now_.v[i] - s * now_.a[i]), f = s * s * (path_bend_[i] - now_.a[i]);
    const double c3 = 10 * d - 4 * e + f / 2, c4 = -15 * d + 7 * e - f, c5 = 6 * d - 3 * e + f / 2;
    hermite_[i] = s * x * (now_.v[i] + s * x / 2 * now_.a[i]) + xx * x * (c3 + x * (c4 + x * c5));
    const double change = trial_.v[i] - now_.v[i];
    v[i] = now_.v[i] + change * xx * (3 - 2 * x) + s * x * (1 - x) * (now_.a[i] * (1 - x) - trial_.a[i] * x);
  }
  move<Spatial>(now_.q, hermite_, q);
}

void SpatialAdaptive::find_gaps(double s, std::optional<Sign>& first) {
  double turning = 0;
  set_poses(system_, time_, now_.q, motion_.terms().at);
  for (int c = 0; c < system_.contacts(); ++c)
    if (!motion_.modes[static_cast<std::size_t>(c)].lasting)
      turning = std::max({turning, motion_.pace(c, now_.v), motion_.pace(c, trial_.v)});
  const int nodes = static_cast<int>(std::clamp(std::ceil(s * turning / kTurnOfNode), 1.0, 1.0 * kMostNodes));
  Node low{0, now_.w.gap, now_.w.gap_rate}, high;
  for (int k = 1; k <= nodes; ++k) {
    high.x = static_cast<double>(k) / nodes;
    if (k == nodes) {
      high.gap = trial_.w.gap, high.rate = trial_.w.gap_rate;
    } else {
      between_ends(s, high.x, q_within_, v_within_);
      motion_.watch_gaps(time_ + high.x * s, q_within_, v_within_, high.gap, high.rate);
    }
    for (int c = 0; c < system_.contacts(); ++c) {
      if (motion_.modes[static_cast<std::size_t>(c)].lasting) continue;
      const std::optional<double> x = closing(c, s, low, high, 0);
      if (x && (!first || *x < first->x)) first = Sign{Watch::gap, c, *x};
    }
    if (first) return;
    std::swap(low, high);
  }
}

/// Where the gap of a contact first falls below zero between two looks at it.
std::optional<double> SpatialAdaptive::closing(int c, double s, const Node& low, const Node& high, int depth) {
  const double part = high.x - low.x, length = part * s, zero = slack({Watch::gap, c, 1});
  const Bernstein<4> gap = cubic(low.gap[c], low.rate[c], high.gap[c], high.rate[c], length);
  const double fast = std::max(now_.w.rate_scale[c], trial_.w.rate_scale[c]);
  const double margin = kCubicError * std::pow(0.125, depth) * length * fast;
  const double least = *std::min_element(gap.begin(), gap.end());
  if (least > margin) return {};
  const bool sure = high.gap[c] < -margin && low.gap[c] > margin;
  if (!sure && depth < kHalvings && margin > zero) {
    Node middle;
    middle.x = (low.x + high.x) / 2;
    Eigen::VectorXd q, v;
    between_ends(s, middle.x, q, v);
    motion_.watch_gaps(time_ + middle.x * s, q, v, middle.gap, middle.rate);
    if (const auto x = closing(c, s, low, middle, depth + 1)) return x;
    return closing(c, s, middle, high, depth + 1);
  }
  const auto found = first_crossing(gap, zero);
  if (!found) return {};
  return low.x + part * found->x;
}

/// Ends of lasting contacts, and of sticking.
void SpatialAdaptive::find_ends(double s, std::optional<Sign>& first) {
  const auto& lasting = motion_.lasting();
  std::vector<std::array<double, 5>> normal(lasting.size()), rooms(lasting.size());
  Eigen::VectorXd q, v, a;
  for (std::size_t k = 0; k < 5; ++k) {
    const bool end = k == 0 || k == 4;
    if (!end) {
      const double x = static_cast<double>(k) / 4;
      between_ends(s, x, q, v);
      if (!motion_.accelerations(std::min(time_ + x * s, stop_), q, v, a)) return;
    }
    for (std::size_t i = 0; i < lasting.size(); ++i) {
      const int c = lasting[i];
      const Point& p = k == 0 ? now_ : trial_;
      normal[i][k] = end ? p.w.normal[c] : motion_.normal_force(i);
      rooms[i][k] =
          end ? room(c, p) : static_friction(system_.law(c)) * normal[i][k] - size_of(motion_.tangent_force(i));
    }
  }
  const auto look = [&](Watch watch, int c, const std::array<double, 5>& values) {
    Sign sign{watch, c, 1};
    const double zero = slack(sign) + std::max(0.0, -values[0]);
    const auto found = first_crossing(quartic(values), zero);
    if (!found) return;
    sign.x = found->x;
    if (!first || sign.x < first->x) first = sign;
  };
  for (std::size_t i = 0; i < lasting.size(); ++i) {
    look(Watch::force, lasting[i], normal[i]);
    if (motion_.modes[static_cast<std::size_t>(lasting[i])].sticks) look(Watch::cone, lasting[i], rooms[i]);
  }
}

/// Shortens the trial step of s to where the value of `sign` is zero. False: it is not negative there; the step is as
/// long as before.
bool SpatialAdaptive::land(const Sign& sign, double& s) {
  constexpr int kIterations = 80;
  const double zero = slack(sign), whole = s, start = value(sign, now_);
  if (sign.watch == Watch::stop) return true;
  double low = 0, f_low = start, high = s, f_high = value(sign, trial_);
  const auto restore = [&] { return attempt(s = whole) < kInf; };
  if (!(f_high < -zero)) {
    bool found = false;
    for (const double part : {0.0, 1.0 / 64, 1.0 / 16, 1.0 / 4, 1.0 / 2}) {
      high = whole * (sign.x + part * (1 - sign.x));
      if (!(high > 0)) high = 1e-3 * whole;
      if (!(attempt(high) < kInf)) continue;
      f_high = value(sign, trial_);
      found = f_high < -zero;
      if (found) break;
    }
    if (!found) return restore(), false;
  }
  const double enough = sign.watch == Watch::gap ? 4 * gap_zero(sign.contact) : zero / 8;
  double guess = std::clamp(sign.x * whole, 0.0, high);
  if (guess <= 0 || guess >= high) guess = high / 2;
  for (int i = 0; i < kIterations; ++i) {
    if (!(attempt(guess) < kInf)) return restore(), false;
    const double f = value(sign, trial_);
    s = guess;
    if (std::abs(f) <= enough && (sign.watch != Watch::gap || trial_.w.gap_rate[sign.contact] < 0 || f < 0)) break;
    if (high - low <= 2 * time_rounding(time_ + high) * 0.125 + 1e-300) break;
    if (f < 0)
      high = guess, f_high = f;
    else
      low = guess, f_low = f;
    double next = sign.watch == Watch::gap ? guess - f / trial_.w.gap_rate[sign.contact]
                                           : (low * f_high - high * f_low) / (f_high - f_low);
    const bool inside = next > low && next < high && (sign.watch != Watch::gap || trial_.w.gap_rate[sign.contact] < 0);
    if (!inside || (sign.watch != Watch::gap && i % 3 == 2) || f_low <= 0) next = (low + high) / 2;
    guess = next;
  }
  return true;
}

}  // namespace orthant
