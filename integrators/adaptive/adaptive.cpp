#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive/adaptive.h>
#include <orthant/integrators/adaptive/crossing_state.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kInnerPart = 1e-3;  // of the tolerance, for an inner step
constexpr double kJointsOff = 1e-6;  // of joints_off(): no state within a step, whose ends hold the joints
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
      terms_(system) {
  left_.impulses.resize(impulses_.size()), left_.smooth.resize(impulses_.size());
  if (system.joint_rows() > 0) joints_.emplace(system);
  if (system.swing() > 0) stride_.longest = kSwing / system.swing();
  if (has_work(system)) meter_.emplace(system);
  events_.reserve(64), left_.events.reserve(64);
}

void Adaptive::remember(CheckpointData& memory) {
  fitted_ = false;  // the polynomial is found again
  memory(engine_, between_, end_.state, before_, last_, stride_.began, stride_.reach, fitted_, end_.status, end_.why,
         end_.residual.joint, end_.residual.rate, left_.events, left_.impulses, left_.smooth, left_.measured,
         left_.work, left_.effort, left_.least_weight, left_.rises, left_.rise, left_.rise_time, end_.gaps);
  if (meter_) meter_->forget();
}

bool Adaptive::goes_on(const State& x) const {
  return last_.q.size() == x.q.size() && std::abs(x.t - last_.t) <= rounding_of(x.t, 0) && x.q == last_.q &&
         x.v == last_.v;
}

void Adaptive::restart(const State& x) {
  end_.state = x;
  stride_.began = x.t, stride_.reach = kFirstReach;
  end_.status = Status::solved;
  left_.events.clear();
  std::fill(left_.impulses.begin(), left_.impulses.end(), Impulse{});
  left_.work = left_.effort = 0, left_.rises = 0;
}

StepReport Adaptive::step(double h, Solver& solver, State& x) {
  StepReport report = StepReport::solved(0);
  if (meter_) report.work = 0;
  why_.clear(), events_.clear();
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  engine_.set_budget(budget());
  if (!goes_on(x)) restart(x);
  const double target = x.t + h, rounding = rounding_of(x.t, h);
  if (end_.state.t <= target + rounding) finish_stride(report);
  while (end_.state.t < target - rounding && end_.status == Status::solved) {
    if (report.accepted + report.rejected >= options_.max_steps) {
      fail(report, Status::iteration_limit, "max_steps used up at t = " + detail::text_of(end_.state.t) + " s");
      break;
    }
    if (!stride(solver, report)) break;
    if (end_.state.t <= target + rounding) finish_stride(report);
  }
  if (end_.status != Status::solved &&
      end_.state.t <= target + rounding) {  // what the last inner step came to shows now
    fail(report, end_.status, end_.why);
    end_.status = Status::solved;
  }
  if (end_.state.t < target - rounding) finish_stride(report);
  hand_out(target, x, report);
  last_ = x;
  return report;
}

/// One inner step. False: it failed, and ends at end_.state.
bool Adaptive::stride(Solver& solver, StepReport& report) {
  const double from = end_.state.t;
  before_ = end_.state;
  const StepReport one = engine_.stride(std::min(stride_.reach, stride_.longest), solver, end_.state);
  if (end_.state.t > from) stride_.reach = std::max(kGrowth * (end_.state.t - from), end_.state.t - stride_.began);
  fitted_ = false;
  report.accepted += one.accepted, report.rejected += one.rejected, report.crossings += one.crossings;
  report.lcp_solves += one.lcp_solves, report.lcp_iterations += one.lcp_iterations;
  report.lcp_rows = std::max(report.lcp_rows, one.lcp_rows);
  report.lcp_residual = std::max(report.lcp_residual, one.lcp_residual);
  report.plastic += one.plastic;
  left_.rises = one.energy_rises, left_.rise = one.energy_rise, left_.rise_time = one.energy_rise_time;
  left_.effort = one.effort, left_.least_weight = one.least_weight;
  report.error_estimate += one.error_estimate;
  end_.residual.joint = one.joint_residual, end_.residual.rate = one.joint_rate;
  left_.events.insert(left_.events.end(), engine_.events().begin(), engine_.events().end());
  left_.impulses = engine_.impulses();
  end_.gaps = engine_.gaps();
  left_.work = one.work.value_or(0);
  if (const Arc& arc = engine_.arc(); meter_ && arc.length > 0) left_.measured = {arc.start, arc.q0, arc.v0};
  std::fill(left_.smooth.begin(), left_.smooth.end(), Impulse{});
  end_.status = one.status, end_.why = engine_.why();
  return end_.status == Status::solved;
}

/// Events, impulses and work of the last inner step, as far as they are still to be handed out.
void Adaptive::finish_stride(StepReport& report) {
  if (meter_) *report.work += left_.work;
  report.effort += left_.effort, report.least_weight = std::min(report.least_weight, left_.least_weight);
  left_.work = left_.effort = 0;
  hand_over_rises(kInf, report);
  events_.insert(events_.end(), left_.events.begin(), left_.events.end());
  left_.events.clear();
  for (std::size_t c = 0; c < left_.impulses.size(); ++c) {
    impulses_[c].normal += left_.impulses[c].normal, impulses_[c].tangent += left_.impulses[c].tangent;
    left_.impulses[c] = {};
  }
}

/// Hands out the energy rises of the inner step once t is behind the largest.
void Adaptive::hand_over_rises(double t, StepReport& report) {
  if (left_.rises == 0 || left_.rise_time > t) return;
  report.note_rise(left_.rise, left_.rise_time, left_.rises);
  left_.rises = 0;
}

/// Likewise those until t, which is within it: impulses of lasting contacts, within the cone of friction.
void Adaptive::hand_over_until(double t) {
  const auto later =
      std::find_if(left_.events.begin(), left_.events.end(), [&](const Event& event) { return event.t > t; });
  events_.insert(events_.end(), left_.events.begin(), later);
  left_.events.erase(left_.events.begin(), later);
  const Arc& arc = engine_.arc();
  for (std::size_t c = 0; c < arc.modes.size(); ++c) {
    if (!arc.modes[c].lasting || !(arc.length > 0)) continue;
    const Impulse until = t < arc.start + arc.length ? between_.impulse(static_cast<int>(c), t) : arc.push[c];
    const double mu = static_mu(system_.law(static_cast<int>(c)));
    const double normal =
        std::clamp(until.normal - left_.smooth[c].normal, 0.0, std::max(0.0, left_.impulses[c].normal));
    const double tangent = std::clamp(until.tangent - left_.smooth[c].tangent, -mu * normal, mu * normal);
    for (Impulse* to : {&impulses_[c], &left_.smooth[c]}) to->normal += normal, to->tangent += tangent;
    left_.impulses[c].normal -= normal, left_.impulses[c].tangent -= tangent;
  }
}

/// Likewise the work on the arc until the state handed out, an eighth of the arc at a time.
void Adaptive::measure_work(const State& to, StepReport& report) {
  if (!meter_ || !fitted_) return;
  const Arc& arc = engine_.arc();
  const double from = left_.measured.t, parts = std::clamp(std::ceil(8 * (to.t - from) / arc.length), 1.0, 8.0);
  for (double k = 1; k <= parts; ++k) {
    part_ = to;
    if (k < parts) part_.t = from + k / parts * (to.t - from), between_.at(part_.t, part_.q, part_.v);
    const double work = meter_->over_motion(left_.measured, part_, arc.modes),
                 effort = std::min(std::abs(work), left_.effort);
    *report.work += work, left_.work -= work;
    report.effort += effort, left_.effort -= effort;
    left_.measured = part_;
  }
}

/// q and v at t, within the last inner step: on its arc, or within the crossing that follows (crossing_state.h), moved
/// onto the joints. Returns the residual of the joints.
ContactMotion::Residual Adaptive::interpolate(double t, State& x) {
  const Arc& arc = engine_.arc();
  const double arc_end = arc.start + arc.length;
  if (arc.length > 0 && t < arc_end) {
    if (!fitted_) between_.fit(arc, options_.rtol);
    fitted_ = true;
    between_.at(t, x.q, x.v);
    return between_.residual();
  }
  x = before_;
  if (arc.length > 0) x.q = arc.q1, x.v = arc.v1, x.t = arc_end;
  move_within_crossing<Planar>(t, end_.state, left_.impulses, x);
  if (!joints_) return {};
  on_joints_ = x;
  const ContactMotion::Residual left = joints_->project(t, on_joints_.q, on_joints_.v);
  if (!(left.joint < kInf)) return joints_->residual(t, x.q, x.v);
  x.q = on_joints_.q, x.v = on_joints_.v;
  return left;
}

/// The state at the end of a call, or where the inner steps ended.
void Adaptive::hand_out(double target, State& x, StepReport& report) {
  if (end_.state.t <= target + rounding_of(target, 0)) {
    x = end_.state;
    if (report.status == Status::solved) x.t = end_.state.t = target;
    report.joint_residual = end_.residual.joint, report.joint_rate = end_.residual.rate;
    gaps_ = end_.gaps;
  } else {
    const ContactMotion::Residual residual = interpolate(target, x);
    report.joint_residual = residual.joint, report.joint_rate = residual.rate;
    hand_over_until(target), hand_over_rises(target, report);
    x.t = target;
    const bool on_arc = target < engine_.arc().start + engine_.arc().length;
    if (report.status == Status::solved && on_arc && residual.off > kJointsOff && residual.off < kInf)
      fail(report, Status::numerical_error, "joints are left at " + detail::text_of(residual.joint) + " m or rad");
    if (on_arc) measure_work(x, report);
    if (system_.contacts() > 0) {
      set_poses(system_, x.t, x.q, terms_.at);
      evaluate_gaps(system_, terms_);
      gaps_ = terms_.gap;
    }
  }
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
}

}  // namespace orthant
