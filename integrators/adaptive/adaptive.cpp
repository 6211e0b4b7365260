#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive/adaptive.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kInnerPart = 1e-3;  // of the tolerance, for an inner step
constexpr double kLeastRelative = 1e-13, kLeastAbsolute = 1e-14;
constexpr double kSwing = 3;                     // [rad]
constexpr double kFirstReach = 1, kGrowth = 10;  // [s], and of the stride before: the longest stride

EventDrivenOptions inner_options(const AdaptiveOptions& options) {
  EventDrivenOptions inner;
  inner.rtol = std::clamp(kInnerPart * options.rtol, kLeastRelative, 1e-4);
  inner.atol = std::clamp(kInnerPart * std::min(options.atol, options.rtol), kLeastAbsolute, 1e-4);
  inner.accumulation = 10 * inner.atol;
  inner.touching = inner.atol;
  inner.max_events = 1000000000;
  inner.go_on = true;
  return inner;
}

/// [s] what sums of times are rounded by.
double rounding_of(double t, double h) { return 8 * kRounding * (std::abs(t) + std::abs(h)); }

}  // namespace

Adaptive::Adaptive(const System& system, const Options& options)
    : Integrator(system, kName, kCan),
      options_(options),
      engine_(system, inner_options(options), kName),
      between_(system),
      terms_(system),
      left_(impulses_.size()),
      smooth_(impulses_.size()) {
  if (system.joint_rows() > 0) joints_.emplace(system);
  if (system.swing() > 0) longest_ = kSwing / system.swing();
  if (has_work(system)) meter_.emplace(system);
  events_.reserve(64), pending_.reserve(64);
}

void Adaptive::remember(Memory& memory) {
  fitted_ = false;  // the polynomial is found again
  memory(engine_, between_, inner_, last_, began_, reach_, fitted_, failed_, failed_why_, joint_residual_, joint_rate_,
         pending_, left_, smooth_, measured_, work_left_, inner_gaps_);
  if (meter_) meter_->forget();
}

bool Adaptive::goes_on(const State& x) const {
  return last_.q.size() == x.q.size() && std::abs(x.t - last_.t) <= rounding_of(x.t, 0) && x.q == last_.q &&
         x.v == last_.v;
}

void Adaptive::restart(const State& x) {
  inner_ = x;
  began_ = x.t, reach_ = kFirstReach;
  failed_ = Status::solved;
  pending_.clear();
  std::fill(left_.begin(), left_.end(), Impulse{});
  work_left_ = 0;
}

StepReport Adaptive::step(double h, Solver& solver, State& x) {
  StepReport report;
  report.accepted = 0;
  if (meter_) report.work = 0;
  why_.clear(), events_.clear();
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  engine_.set_budget(budget());
  if (!goes_on(x)) restart(x);
  const double target = x.t + h, rounding = rounding_of(x.t, h);
  if (inner_.t <= target + rounding) finish_stride(report);
  while (inner_.t < target - rounding && failed_ == Status::solved) {
    if (report.accepted + report.rejected >= options_.max_steps) {
      fail(report, Status::iteration_limit, "max_steps used up at t = " + detail::text_of(inner_.t) + " s");
      break;
    }
    if (!stride(solver, report)) break;
    if (inner_.t <= target + rounding) finish_stride(report);
  }
  if (failed_ != Status::solved && inner_.t <= target + rounding) {  // what the last inner step came to shows now
    fail(report, failed_, failed_why_);
    failed_ = Status::solved;
  }
  if (inner_.t < target - rounding) finish_stride(report);
  hand_out(target, x, report);
  last_ = x;
  return report;
}

/// One inner step. False: it failed, and ends at inner_.
bool Adaptive::stride(Solver& solver, StepReport& report) {
  const double from = inner_.t;
  const StepReport one = engine_.stride(std::min(reach_, longest_), solver, inner_);
  if (inner_.t > from) reach_ = std::max(kGrowth * (inner_.t - from), inner_.t - began_);
  fitted_ = false;
  report.accepted += one.accepted, report.rejected += one.rejected, report.crossings += one.crossings;
  report.lcp_solves += one.lcp_solves, report.lcp_iterations += one.lcp_iterations;
  report.lcp_rows = std::max(report.lcp_rows, one.lcp_rows);
  report.lcp_residual = std::max(report.lcp_residual, one.lcp_residual);
  report.energy_rise = std::max(report.energy_rise, one.energy_rise), report.plastic += one.plastic;
  report.error_estimate += one.error_estimate;
  joint_residual_ = one.joint_residual, joint_rate_ = one.joint_rate;
  pending_.insert(pending_.end(), engine_.events().begin(), engine_.events().end());
  left_ = engine_.impulses();
  inner_gaps_ = engine_.gaps();
  work_left_ = one.work.value_or(0);
  if (const Arc& arc = engine_.arc(); meter_ && arc.length > 0) measured_ = {arc.start, arc.q0, arc.v0};
  std::fill(smooth_.begin(), smooth_.end(), Impulse{});
  failed_ = one.status, failed_why_ = engine_.why();
  return failed_ == Status::solved;
}

/// Events, impulses and work of the last inner step, as far as they are still to be handed out.
void Adaptive::finish_stride(StepReport& report) {
  if (meter_) *report.work += work_left_;
  work_left_ = 0;
  events_.insert(events_.end(), pending_.begin(), pending_.end());
  pending_.clear();
  for (std::size_t c = 0; c < left_.size(); ++c) {
    impulses_[c].normal += left_[c].normal, impulses_[c].tangent += left_[c].tangent;
    left_[c] = {};
  }
}

/// Likewise those until t, which is within it: what lasting contacts took, within the cone of friction.
void Adaptive::hand_over_until(double t) {
  const auto later = std::find_if(pending_.begin(), pending_.end(), [&](const Event& event) { return event.t > t; });
  events_.insert(events_.end(), pending_.begin(), later);
  pending_.erase(pending_.begin(), later);
  const Arc& arc = engine_.arc();
  for (std::size_t c = 0; c < arc.modes.size(); ++c) {
    if (!arc.modes[c].lasting || !(arc.length > 0)) continue;
    const Impulse until = t < arc.start + arc.length ? between_.impulse(static_cast<int>(c), t) : arc.push[c];
    const double mu = static_mu(system_.law(static_cast<int>(c)));
    const double normal = std::clamp(until.normal - smooth_[c].normal, 0.0, std::max(0.0, left_[c].normal));
    const double tangent = std::clamp(until.tangent - smooth_[c].tangent, -mu * normal, mu * normal);
    for (Impulse* to : {&impulses_[c], &smooth_[c]}) to->normal += normal, to->tangent += tangent;
    left_[c].normal -= normal, left_[c].tangent -= tangent;
  }
}

/// Likewise the work on the arc until the state handed out.
void Adaptive::measure_work(const State& to, StepReport& report) {
  if (!meter_ || !fitted_) return;
  const double work = meter_->over_motion(measured_, to, engine_.arc().modes);
  *report.work += work, work_left_ -= work;
  measured_ = to;
}

/// q and v at t, within the last inner step: on its arc, or within the crossing that follows, where they are taken from
/// the straight line between its ends, and moved onto the joints. Returns the residual of the joints.
ContactMotion::Residual Adaptive::interpolate(double t, State& x) {
  const Arc& arc = engine_.arc();
  const double arc_end = arc.start + arc.length;
  if (arc.length > 0 && t < arc_end) {
    if (!fitted_) between_.fit(arc, options_.rtol);
    fitted_ = true;
    between_.at(t, x.q, x.v);
    return between_.residual();
  }
  if (arc.length > 0) x.q = arc.q1, x.t = arc_end;  // else x is where the inner step began, or a place since
  move(x.q, (t - x.t) / (inner_.t - x.t) * between(x.q, inner_.q));
  x.v = inner_.v;
  if (!joints_) return {};
  on_joints_ = x;
  const ContactMotion::Residual left = joints_->project(t, on_joints_.q, on_joints_.v);
  if (!(left.joint < kInf)) return joints_->residual(t, x.q, x.v);
  x.q = on_joints_.q, x.v = on_joints_.v;
  return left;
}

/// The state at the end of a call, or where the inner steps ended.
void Adaptive::hand_out(double target, State& x, StepReport& report) {
  if (inner_.t <= target + rounding_of(target, 0)) {
    x = inner_;
    if (report.status == Status::solved) x.t = inner_.t = target;
    report.joint_residual = joint_residual_, report.joint_rate = joint_rate_;
    gaps_ = inner_gaps_;
  } else {
    const ContactMotion::Residual residual = interpolate(target, x);
    report.joint_residual = residual.joint, report.joint_rate = residual.rate;
    hand_over_until(target);
    x.t = target;
    if (target < engine_.arc().start + engine_.arc().length) measure_work(x, report);
    if (system_.contacts() > 0) {
      set_poses(system_, x.t, x.q, terms_.at);
      evaluate_gaps(system_, terms_);
      gaps_ = terms_.gap;
    }
  }
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
}

}  // namespace orthant
