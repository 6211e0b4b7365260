#include <orthant/core/support/options.h>
#include <orthant/integrators/event_driven/spatial_event_driven.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kMostSwing = 3;      // [rad]
constexpr double kLongestTurn = 1.5;  // [rad] of a body in a step
constexpr double kStable = 0.5;       // of the time in which the direction of slip returns: a step
constexpr double kTurnShare = 10;     // of rtol: of speeds, and of what friction makes in a second
constexpr double kStopShare = 0.95;   // of the time until slip stops
constexpr int kShortInARow = 15, kMostTries = 200;
constexpr double kShortStep = 1e-10;  // [s]
constexpr double kSoonAgain = 50;     // crossings: no calm has come since the last one

}  // namespace

SpatialEventDriven::Point::Point(const System& system)
    : q(system.coordinates()),
      v(system.dof()),
      a(Eigen::VectorXd::Zero(system.dof())),
      w(system.contacts()),
      force(Eigen::VectorXd::Zero(3 * system.contacts() + 1)) {}

SpatialEventDriven::SpatialEventDriven(const System& system, const Options& options, std::string_view name)
    : IntegratorOf<Spatial>(system, name, kCan),
      options_(options),
      measures_(has_work(system)),
      motion_(system),
      transition_(system),
      immobility_(system),
      formulation_(system),
      impact_(system),
      flow_(system, measures_),
      stepping_(system, {}),
      turns_(system, kInf),
      now_(system),
      trial_(system),
      path_scale_(system.dof()),
      v_scale_(system.dof()),
      tie_(impulses_.size()),
      bounces_(impulses_.size()),
      touching_(impulses_.size()),
      released_(impulses_.size()),
      in_turn_(impulses_.size()),
      slides_(impulses_.size(), Vector3d::Zero()),
      struck_(impulses_.size()),
      fall_(system.contacts()),
      struck_scale_(Eigen::VectorXd::Zero(system.contacts())),
      none_(Eigen::VectorXd::Zero(system.dof())),
      shown_(&formulation_) {
  formulation_.refine(), impact_.refine();
  stepping_.keep_restitution();
  if (measures_) meter_.emplace(system);
  const auto refuse = [&](const char* what) {
    throw std::invalid_argument("integrator " + std::string(name) + ": takes no " + what +
                                " in space: must be moreau-jean or another integrator of fixed step");
  };
  if (!system.scene().collisions.empty()) refuse("searched collisions");
  if (!system.scene().frictions.empty()) refuse("dry friction in joints");
  if (system.swing() > 0) swing_ = kMostSwing / system.swing();
  events_.reserve(64);
}

void SpatialEventDriven::remember(CheckpointData& memory) {
  memory(time_, next_, begun_, load_, flight_, now_.q, now_.v, arc_, last_, crowd_.steps, crowd_.standstill,
         crowd_.length, crowd_.end, bounces_, motion_, transition_, formulation_, impact_, stepping_, turns_);
  memory(now_.residual.joint, now_.residual.rate, now_.residual.off);
  fresh_ = false;
}

// --- Calls ----------------------------------------------------------------------------------------------------------

bool SpatialEventDriven::goes_on(const State& x) const {
  return last_.q.size() == x.q.size() && std::abs(x.t - last_.t) <= time_rounding(x.t) && x.q == last_.q &&
         x.v == last_.v;
}

void SpatialEventDriven::restart(const State& x) {
  now_.q = x.q, now_.v = x.v;
  next_ = options_.first_step;
  turns_.restart();
  begun_ = fresh_ = false;
  std::fill(bounces_.begin(), bounces_.end(), DatedBounces{});
  crowd_ = {}, flight_ = {};
}

void SpatialEventDriven::begin_call(const State& x) {
  why_.clear(), events_.clear(), failed_ = {};
  work_ = effort_ = 0, crowd_.instants = 0;
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  formulation_.clear(), shown_ = &formulation_;
  if (!goes_on(x)) restart(x);
  time_ = x.t;
}

void SpatialEventDriven::end_call(State& x, StepReport& report) {
  if (failed_.status != Status::solved) fail(report, failed_.status, failed_.why);
  x.t = time_, x.q = now_.q, x.v = now_.v;
  last_ = x;
  if (measures_) report.work = report.work.value_or(0) + work_, report.effort += effort_;
  report.joint_residual = now_.residual.joint, report.joint_rate = now_.residual.rate;
  sort_events();
  gaps_ = now_.w.gap + motion_.resting_gaps();
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
}

StepReport SpatialEventDriven::step(double h, Solver& solver, State& x) {
  StepReport report;
  report.accepted = 0;
  begin_call(x);
  const double target = end_ = x.t + h, rounding = time_rounding(target);
  bool going = true;
  while (going && time_ < target - rounding && !stopped(report)) going = go(target - time_, solver, report);
  if (report.status == Status::solved && going) time_ = target;
  end_call(x, report);
  return report;
}

bool SpatialEventDriven::stride(double h, Solver& solver, State& x, StepReport& report) {
  begin_call(x), end_ = kInf;
  const bool going = go(h, solver, report);
  end_call(x, report);
  return going;
}

/// Those of accumulations lie a little ahead of their place.
void SpatialEventDriven::sort_events() {
  std::stable_sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) { return a.t < b.t; });
}

// --- Steps ----------------------------------------------------------------------------------------------------------

bool SpatialEventDriven::give_up(Status status, std::string why) {
  failed_ = {status, std::move(why)};
  return false;
}

bool SpatialEventDriven::begin(Solver& solver, StepReport& report) {
  begun_ = true;
  motion_.open_all();
  motion_.rest(time_, now_.q, options_.atol);
  now_.residual = motion_.project(time_, now_.q, now_.v);
  if (!observe(now_, time_)) return give_up(Status::numerical_error, "no accelerations at the start");
  return change_or_cross(solver, {}, report);
}

/// One step of h at the most. False: it failed, and ends at time_.
bool SpatialEventDriven::go(double h, Solver& solver, StepReport& report) {
  arc_.length = 0;
  const double from = time_;
  stop_ = kInf;
  if (!tells_turns()) return false;
  const bool begins = !begun_;
  bool going = begun_ || begin(solver, report);
  if (going && !fresh_) going = observe(now_, time_) || give_up(Status::numerical_error, "no accelerations");
  // An impact at the start ends a stride of its own: what comes after it belongs to later times.
  const bool struck = begins && std::ranges::any_of(impulses_, [](const Impulse& i) { return i.normal != 0; });
  if (going && time_ == from && !struck) going = advance(h, solver, report);
  if (going) going = tells_turns();
  if (now_.undetermined) ++report.undetermined;
  if (going) report.status = Status::solved, failed_ = {};
  return going;
}

bool SpatialEventDriven::tells_turns() {
  return turns_.follow(time_, now_.q, now_.v) || give_up(Status::numerical_error, turns_.why());
}

/// Accelerations and all that is watched; p.q and p.v are given.
bool SpatialEventDriven::observe(Point& p, double t) {
  if (!motion_.accelerations(std::min(t, stop_), p.q, p.v, p.a)) return false;
  flow_.forces(motion_, std::min(t, stop_), p.v, p.a, p.force);
  p.undetermined = motion_.undetermined();
  motion_.watch(p.q, p.v, p.a, p.w);
  if (&p == &now_) fresh_ = true;
  return true;
}

/// [s] that a step may have, at most.
double SpatialEventDriven::longest(double rest) const {
  double s = std::min(rest, swing_);
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

double SpatialEventDriven::first_guess() const {
  const double fast = std::max(now_.v.lpNorm<Eigen::Infinity>(), 1e-3);
  return std::clamp(0.1 * fast / std::max(now_.a.lpNorm<Eigen::Infinity>(), 1e-10), 1e-6, 1.0);
}

/// A step of s to trial_: its error over the tolerance; infinity: there is none.
double SpatialEventDriven::attempt(double s, bool whatever) {
  if (!flow_.step(motion_, start_, now_.a, now_.force, s, stop_, trial_.q, trial_.v)) return kInf;
  const double rtol = options_.rtol, atol = options_.atol;
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
  double error = flow_.error(s, path_scale_, v_scale_);
  if (!(error <= 1) && !(whatever && error < kInf)) return std::isnan(error) ? kInf : error;
  path_ = flow_.path();
  v_within_ = trial_.v;
  trial_.residual = motion_.project(time_ + s, trial_.q, trial_.v);
  error = std::max(error, kProjectedShare * ((v_within_ - trial_.v).array() / v_scale_.array()).abs().maxCoeff());
  return trial_.residual.joint < kInf && observe(trial_, time_ + s) ? error : kInf;
}

/// Some contact's slip has gone through zero in the trial step.
bool SpatialEventDriven::turned() const {
  return std::ranges::any_of(motion_.lasting(), [&](int c) {
    const auto i = static_cast<std::size_t>(c);
    return motion_.modes[i].slides && now_.w.along[i].dot(trial_.w.along[i]) < 0 &&
           trial_.w.slip[c] > slip_zero(trial_) && now_.w.slip[c] > slip_zero(now_);
  });
}

/// [m/s] what the turn of a departing contact may leave out of its slip.
double SpatialEventDriven::left_out(std::size_t k) const {
  return options_.atol + kTurnShare * options_.rtol * (now_.v.lpNorm<Eigen::Infinity>() + motion_.grip(k));
}

/// The trial step is too long for a departure: the turn in it counts.
bool SpatialEventDriven::overdue() const {
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
void SpatialEventDriven::end_departures() {
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

/// The first event in the trial step of s, which ends there.
auto SpatialEventDriven::find_event(double& s, std::optional<Sign>& event) -> Search {
  event.reset(), dismissed_.clear();
  for (int i = 0;;) {
    const std::optional<Sign> next = first_sign(s);
    if (!next) return Search::done;
    if (i == kMostTries) return Search::endless;
    const double before = s;
    const Landing landing = land(*next, s);
    if (landing == Landing::fails) return Search::fails;
    if (landing == Landing::none) {
      dismissed_.push_back(*next);  // rounding: later ones of other contacts count all the same
      continue;
    }
    event = next, ++i;
    if (!(s < before)) return Search::done;
  }
}

/// One accepted step, with the event at its end if there is one.
bool SpatialEventDriven::advance(double h, Solver& solver, StepReport& report) {
  const double stop = system_.next_breakpoint(time_ + time_rounding(time_));
  const double rest = stop - time_;
  stop_ = std::nextafter(stop, -kInf);
  if (!(next_ > 0)) next_ = first_guess();
  start_.t = time_, start_.q = now_.q, start_.v = now_.v;
  double s = std::min(next_, longest(std::min(h, rest)));
  double error = kInf;
  std::optional<Sign> event;
  const auto stalls = [&](const char* what, const char* then) {
    return give_up(Status::stalled, what + (" at t = " + detail::text_of(time_)) + then) ||
           (options_.go_on && cross(solver, report));
  };
  for (;;) {
    error = attempt(s);
    const double factor =
        error < kInf ? std::clamp(0.9 * std::pow(error, -1 / ChartRungeKutta::kErrorOrder), 0.2, 6.0) : 0.2;
    if (error <= 1 && !turned() && !overdue()) {
      next_ = s < next_ ? std::max(next_, factor * s) : factor * s;
      const double whole = s;
      const Search search = find_event(s, event);
      if (search == Search::done) break;
      if (search == Search::endless) return stalls("no first event was found", "");
      s = whole;
    }
    ++report.rejected;
    next_ = s *= error <= 1 ? 0.3 : factor;
    if (s < 1e-3 * time_rounding(time_) + 1e-30)
      return stalls("step size below rounding", ": the forces grow without bound, or tolerances are too small");
  }
  ++report.accepted;
  report.error_estimate += error * path_scale_.maxCoeff();
  accept(s, s >= rest, stop);
  if (!tells_turns()) return false;
  if (s >= rest) {  // a force or its slope jumps
    stop_ = kInf;
    if (!observe(now_, time_)) return give_up(Status::numerical_error, "no accelerations");
    return change_or_cross(solver, event, report);
  }
  if (crowd_.steps > (time_ - crowd_.end < kSoonAgain * crowd_.length ? kShortInARow / 4 : kShortInARow))
    return give_up(Status::stalled, "events repeat without end at t = " + detail::text_of(time_)) ||
           cross(solver, report);
  if (!event) return end_departures(), true;
  return change_or_cross(solver, event, report);
}

/// Takes the trial step.
void SpatialEventDriven::accept(double s, bool at_stop, double stop) {
  arc_.start = start_, arc_.a = now_.a, arc_.force = now_.force, arc_.modes = motion_.modes, arc_.length = s;
  arc_.rest = motion_.resting_gaps();
  for (const int c : motion_.lasting()) load_ = std::max(load_, now_.w.normal[c]);
  std::swap(now_, trial_);
  const double before = time_;
  time_ = at_stop ? stop : time_ + s;
  ++flight_.steps, flight_.time += s;
  crowd_.steps = s < kShortStep ? crowd_.steps + 1 : 0;
  crowd_.standstill = time_ > before ? 0 : crowd_.standstill + 1;
  const Eigen::VectorXd& push = flow_.push();
  for (const int c : motion_.lasting()) {
    Impulse& sum = impulses_[static_cast<std::size_t>(c)];
    sum.normal += push[3 * c], sum.tangent += Tangents{push[3 * c + 1], push[3 * c + 2]};
  }
  if (measures_) work_ += push[push.size() - 1], effort_ += std::abs(push[push.size() - 1]);
  motion_.forget_overlaps(now_.w);
}

}  // namespace orthant
