#include <orthant/core/mechanics/dynamics/redundancy.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/between_events/look_ahead.h>
#include <orthant/integrators/event_driven/event_driven.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kUntold = 1e-4;   // independence, of joints that are redundant anyway, of poses not to be passed
constexpr double kRegular = 3e-2;  // root of that, of rows in the best order
constexpr int kShortSteps = 15;    // steps in a row, each shorter than
constexpr int kLandings = 200;     // tries to find a step's first event
constexpr double kNowhere = 1e-9;  // of places and sizes: unless bodies move by more in such a step

/// True without drives, dampers and dry friction in joints: then only contacts and loads change the energy.
bool conserves(const System& system) {
  const auto damped = [](const Spring& spring) {
    return std::visit([](const auto& s) { return s.damping != 0; }, spring);
  };
  return !system.driven() && system.scene().frictions.empty() && std::ranges::none_of(system.scene().springs, damped);
}

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
      stepping_(system),
      now_(system),
      trial_(system),
      middle_(system),
      earlier_(system),
      scale_{Eigen::VectorXd(system.dof()), Eigen::VectorXd(system.dof()), Eigen::VectorXd::Zero(system.dof())},
      strike_(impulses_.size()),
      freed_(impulses_.size()),
      none_(Eigen::VectorXd::Zero(system.dof())),
      bounces_(impulses_.size()),
      flow_(2 * system.contacts() + 1),
      force_(2 * system.contacts() + 1),
      before_(impulses_.size()),
      conservative_(conserves(system)),
      carries_(system.driven() ||
               std::ranges::any_of(system.laws(), [](const ContactLaw& law) { return law.belt != 0; })),
      shown_(&formulation_) {
  formulation_.refine(), impact_.refine();
  stepping_.keep_restitution();
  ListedContacts::refuse(system, name);
  events_.reserve(64 * impulses_.size());
  for (const Body& body : system.scene().bodies) size_ = std::max(size_, std::sqrt(body.inertia / body.mass));
  if (has_work(system)) meter_.emplace(system);
  pulleys_.emplace(*this, system.initial_state());
  if (pulleys_->empty()) pulleys_.reset();
  const double unit = system.length_unit();
  for (double* limit : {&options_.atol, &options_.touching, &options_.accumulation}) *limit *= unit;
  atol_.setConstant(system.dof(), options.atol);
  for (Index i = 0; i < atol_.size(); ++i)
    if (!is_rotation(i)) atol_[i] = options_.atol;
  std::fill(watch_.slow.begin(), watch_.slow.end(), options_.atol);
}

StepReport EventDriven::go(double h, bool one, Solver& solver, State& x) {
  StepReport report = StepReport::solved(0);
  events_.clear(), why_.clear();
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  formulation_.clear(), shown_ = &formulation_;
  const bool known = good_ && last_q_ == x.q && last_v_ == x.v;
  crossing_.end = known ? crossing_.end - (x.t - start_) : -kInf;
  work_ = known ? -lead_.work : 0, lead_.work = 0, effort_ = 0, least_weight_ = kInf;
  start_ = x.t, elapsed_ = known ? -lead_.time : 0, lead_.time = 0;
  if (!known || !one) crowd_.standstill = crowd_.steps = crowd_.shared = crowd_.instants = 0, crossing_.goes_on = false;
  striding_ = one, arc_.length = 0;
  good_ = known || begin(solver, x, report) || (options_.go_on && cross(solver, h, report));
  for (bool more = good_ && elapsed_ < h; more && lead_.time == 0 && elapsed_ < h; more = good_ && !one) {
    if (stopped(report)) {
      good_ = false;
      break;
    }
    const double stop = next_stop() - start_;
    good_ = crossing_.goes_on ? cross(solver, std::min(h, stop), report)
                              : advance(solver, std::min(h, stop), stop > h, report);
    if (good_ && pulleys_) good_ = keeps_directions(report);
    if (good_ && elapsed_ == stop) good_ = renew(solver, report) || (options_.go_on && cross(solver, h, report));
  }
  const Point& end = lead_.time > 0 ? trial_ : now_;
  if (meter_ && lead_.time > 0)
    lead_.work = meter_->over_motion(start_ + elapsed_, h - elapsed_, now_, trial_, motion_.modes);
  if (meter_) report.work = work_ + lead_.work, report.effort = effort_ + std::abs(lead_.work);
  report.least_weight = least_weight_;
  if (one && lead_.time > 0) note_lead();
  x.t = start_ + (lead_.time > 0 ? h : elapsed_), x.q = end.q, x.v = end.v;
  gaps_ = end.w.gap;
  const ContactMotion::Residual& residual = lead_.time > 0 ? trial_residual_ : residual_;
  report.joint_residual = residual.joint, report.joint_rate = residual.rate;
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
  sort_events();
  if (good_ && !(residual.off <= kJointsHold)) {
    if (one && arc_.length > 0)
      x.t = arc_.start, x.q = arc_.q0, x.v = arc_.v0, arc_.length = 0;  // no arc fits the joints
    good_ = fail_apart(residual.joint, report);
  }
  last_q_ = x.q, last_v_ = x.v;
  return report;
}

void EventDriven::remember(CheckpointData& memory) {
  memory(good_, last_q_, last_v_, now_, start_, elapsed_, h_, scale_.noise, lead_, joints_, load_, flight_, bounces_,
         crossing_, no_answer_, residual_, motion_, formulation_, impact_, stepping_, crowd_, arc_, flow_);
  if (pulleys_) memory(*pulleys_);
  if (meter_) meter_->forget();
}

/// False: a taut rope's end has passed its pulley in an inner step.
bool EventDriven::keeps_directions(StepReport& report) {
  const auto pulls = [&](int c) { return std::ranges::find(motion_.lasting(), c) != motion_.lasting().end(); };
  return pulleys_->admits({start_ + elapsed_, now_.q, now_.v}, pulls) ||
         fail(report, Status::numerical_error, pulleys_->why());
}

/// The step that was only looked at, next to a singular pose.
void EventDriven::note_lead() {
  std::swap(now_, trial_);
  elapsed_ += lead_.time;
  note_arc(elapsed_ - lead_.time);
  elapsed_ -= lead_.time;
  std::swap(now_, trial_);
}

/// Those of accumulations lie a little ahead of their place.
void EventDriven::sort_events() {
  const auto earlier = [](const Event& a, const Event& b) { return a.t < b.t; };
  for (auto end = events_.begin(); end != events_.end(); ++end)
    std::rotate(std::upper_bound(events_.begin(), end, *end, earlier), end, end + 1);
}

bool EventDriven::fail_apart(double residual, StepReport& report) {
  return fail(report, Status::numerical_error,
              "the projection onto the joints ends at " + detail::text_of(residual) + " m");
}

bool EventDriven::begin(Solver& solver, const State& x, StepReport& report) {
  now_.q = x.q, now_.v = x.v, h_ = options_.first_step;
  flight_.steps = 0, flight_.time = 0;
  scale_.noise.setZero(now_.v.size()), flow_.restart();
  std::fill(bounces_.begin(), bounces_.end(), Bounces{});
  std::fill(motion_.modes.begin(), motion_.modes.end(), ContactMode{});
  motion_.modes_changed();
  residual_ = motion_.project(x.t, now_.q, now_.v);
  if (!(residual_.off <= kJointsHold)) return fail_apart(residual_.joint, report);
  if (pulleys_) pulleys_->follow(x);
  joints_.rank = 0;
  if (!observe(now_, x.t)) return fail(report, Status::numerical_error, "no accelerations at the start");
  return change_modes(solver, {}, report);
}

/// Where a force or its slope jumps next [s]; a jump no farther than rounding of the time has been passed.
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
      report.error_estimate += error * scale_.q.maxCoeff();
      break;
    }
    if (error < kInf && turns(s) && find_turn(s)) return turn(solver, s, end, report);
    if (report.rejected == rejected) measure_noise();
    ++report.rejected;
    h_ = s *= error < kInf ? factor : 0.1;
    if (s < shortest_step())
      return fail(report, Status::stalled,
                  "step size below rounding at t = " + detail::text_of(start_ + elapsed_) +
                      ": the forces grow without bound, or tolerances are too small") ||
             (options_.go_on && cross(solver, end, report));
  }
  if (joints_.rank < system_.joint_rows() && joints_.least_independence < kUntold &&
      pivoted_independence(system_, least_q_, joints_.rank) < kRegular)
    return fail(report, Status::numerical_error,
                std::string(kSingularPose) + " at t = " + detail::text_of(start_ + elapsed_) +
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
    if (event && find_jump(*event, s)) return turn(solver, s, end, report);
    if (!(s < before)) break;  // rounding: found again where the step ends already
  }
  ++report.accepted;
  if (early && last && !event && motion_.lasting().empty()) return hand_out(rest);
  ++flight_.steps, flight_.time += s;
  accept(s, end);
  if (crowd_.steps > (elapsed_ - crossing_.end < kSoon * crossing_.step ? kShortSteps / 4 : kShortSteps))
    return fail(report, Status::stalled, "events repeat without end at t = " + detail::text_of(start_ + elapsed_)) ||
           cross(solver, end, report);
  return !event || change_modes(solver, event, report) ||
         ((no_answer_ || options_.go_on) && cross(solver, end, report));
}

/// Takes the trial step, at the end of which contacts have turned: they are let go, and what follows is decided again.
bool EventDriven::turn(Solver& solver, double s, double end, StepReport& report) {
  freed_.released.assign(freed_.turned.begin(), freed_.turned.end());
  accept(s, end);
  ++report.accepted, h_ = 0;
  for (int c = 0; c < system_.contacts(); ++c) {
    if (!freed_.released[at(c)]) continue;
    motion_.modes[at(c)] = {};
    events_.push_back({start_ + elapsed_, EventKind::release, c, 0, 0});
  }
  motion_.modes_changed();
  residual_ = motion_.project(start_ + elapsed_, now_.q, now_.v);
  if (!observe(now_, start_ + elapsed_)) return fail(report, Status::numerical_error, "no accelerations");
  return change_modes(solver, {}, report) || ((no_answer_ || options_.go_on) && cross(solver, end, report));
}

void EventDriven::accept(double s, double end) {
  const double before = elapsed_;
  load_ = std::max(load_, now_.w.normal.size() > 0 ? now_.w.normal.maxCoeff() : 0);
  const Eigen::VectorXd& mean = flow_.mean();
  if (meter_) add_work(s * mean[mean.size() - 1]);
  flow_.take(s);
  least_weight_ = std::min(least_weight_, potential_of_weight(system_, trial_.q));
  std::swap(now_, trial_);
  residual_ = trial_residual_;
  elapsed_ = s < end - elapsed_ ? elapsed_ + s : end;
  crowd_.standstill = elapsed_ > before ? 0 : crowd_.standstill + 1;
  const double moved = s * largest_of_all(now_.v, system_.length_unit());
  const bool crowd = s < kCrowded * options_.crossing &&
                     moved <= kNowhere * std::max(size_, largest_of_all(now_.q, system_.length_unit()));
  crowd_.steps = crowd ? crowd_.steps + 1 : 0, crowd_.shared = crowd ? crowd_.shared : 0;
  for (const int c : motion_.lasting())
    impulses_[at(c)].normal += s * mean[2 * c], impulses_[at(c)].tangent += s * mean[2 * c + 1];
  if (striding_) note_arc(before);
  behind_ = 0;
}

/// Of the step just accepted, from `before` after the call's start.
void EventDriven::note_arc(double before) {
  arc_.start = start_ + before, arc_.length = elapsed_ - before;
  arc_.q0 = trial_.q, arc_.v0 = trial_.v, arc_.a0 = trial_.a;
  arc_.q1 = now_.q, arc_.v1 = now_.v, arc_.a1 = now_.a;
  move(arc_.q1, -behind_ * now_.v);  // the forces at its end are those before the jump
  arc_.modes = motion_.modes;
  arc_.push = impulses_;
}

}  // namespace orthant
