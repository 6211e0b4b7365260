#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive/crossing_state.h>
#include <orthant/integrators/adaptive/spatial_adaptive.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kInnerShare = 1e-3;  // of the tolerance, for an inner step
constexpr double kTail = 5;  // [m] times rtol²: weight makes bounces that low no faster than 10 m/s times rtol

EventDrivenOptions inner_options_in_space(const AdaptiveOptions& options) {
  EventDrivenOptions inner;
  inner.rtol = std::clamp(kInnerShare * options.rtol, 1e-13, 1e-4);
  inner.atol = std::clamp(kInnerShare * std::min(options.atol, options.rtol), 1e-14, 1e-4);
  inner.accumulation = std::min(10 * inner.atol, kTail * options.rtol * options.rtol);
  inner.touching = inner.atol;
  inner.max_events = 1000000000;
  inner.go_on = true;
  return inner;
}

double rounding_in(double t) { return 0x1p-49 * std::abs(t); }

}  // namespace

SpatialAdaptive::SpatialAdaptive(const System& system, const Options& options)
    : IntegratorOf<Spatial>(system, kName, kCan),
      options_(options),
      engine_(system, inner_options_in_space(options), kName),
      between_(system),
      flow_(system, has_work(system)),
      measures_(has_work(system)),
      push_(Eigen::VectorXd::Zero(3 * system.contacts() + 1)),
      handed_push_(push_),
      handed_(system) {
  left_.impulses.resize(impulses_.size());
  events_.reserve(64), left_.events.reserve(64);
}

void SpatialAdaptive::remember(CheckpointData& memory) {
  memory(engine_, between_, inner_, before_, last_, began_, reach_, joint_residual_, joint_rate_, handed_push_,
         left_.events, left_.impulses, left_.work, left_.undetermined, failed_.status, failed_.why);
  fitted_ = false;
}

bool SpatialAdaptive::goes_on(const State& x) const {
  return last_.q.size() == x.q.size() && std::abs(x.t - last_.t) <= rounding_in(x.t) && x.q == last_.q &&
         x.v == last_.v;
}

void SpatialAdaptive::restart(const State& x) {
  inner_ = before_ = x;
  began_ = x.t, reach_ = 1;
  failed_ = {};
  left_.events.clear(), left_.work = 0, left_.undetermined = 0;
  std::fill(left_.impulses.begin(), left_.impulses.end(), Impulse{});
}

StepReport SpatialAdaptive::step(double h, Solver& solver, State& x) {
  StepReport report = StepReport::solved(0);
  if (measures_) report.work = 0;
  why_.clear(), events_.clear();
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  engine_.set_budget(budget());
  if (!goes_on(x)) restart(x);
  const double target = x.t + h, rounding = rounding_in(target);
  if (inner_.t <= target + rounding) hand_over_all(report);
  while (inner_.t < target - rounding && failed_.status == Status::solved) {
    if (stopped(report)) break;
    if (report.accepted + report.rejected >= options_.max_steps) {
      fail(report, Status::iteration_limit, "max_steps used up at t = " + detail::text_of(inner_.t) + " s");
      break;
    }
    stride(solver, report);
    if (inner_.t <= target + rounding) hand_over_all(report);
  }
  if (failed_.status != Status::solved &&
      inner_.t <= target + rounding) {  // what the last inner step came to shows now
    fail(report, failed_.status, failed_.why);
    failed_ = {};
  }
  hand_out(target, x, report);
  last_ = x;
  return report;
}

/// One inner step; it may fail, and ends at inner_.
void SpatialAdaptive::stride(Solver& solver, StepReport& report) {
  before_ = inner_, fitted_ = false;
  const std::optional<double> work = report.work;
  const int undetermined = report.undetermined;
  const bool going = engine_.stride(reach_, solver, inner_, report);
  left_.work += report.work.value_or(0) - work.value_or(0);
  report.work = work;
  left_.undetermined += report.undetermined - undetermined;
  report.undetermined = undetermined;
  failed_ = going ? Failure{} : Failure{report.status, engine_.why()};
  report.status = Status::solved;
  if (inner_.t > before_.t) reach_ = std::max(10 * (inner_.t - before_.t), inner_.t - began_);
  joint_residual_ = report.joint_residual, joint_rate_ = report.joint_rate;
  left_.events.insert(left_.events.end(), engine_.events().begin(), engine_.events().end());
  for (std::size_t c = 0; c < impulses_.size(); ++c) {
    const Impulse& one = engine_.impulses()[c];
    left_.impulses[c].normal += one.normal, left_.impulses[c].tangent += one.tangent;
  }
  handed_push_.setZero();
}

/// Events, impulses and work of the last inner step, as far as they are still to be handed out.
void SpatialAdaptive::hand_over_all(StepReport& report) {
  if (measures_) *report.work += left_.work;
  report.undetermined += left_.undetermined;
  left_.work = 0, left_.undetermined = 0;
  events_.insert(events_.end(), left_.events.begin(), left_.events.end());
  left_.events.clear();
  for (std::size_t c = 0; c < impulses_.size(); ++c) {
    impulses_[c].normal += left_.impulses[c].normal, impulses_[c].tangent += left_.impulses[c].tangent;
    left_.impulses[c] = {};
  }
}

/// The state at the end of a call, or where the inner steps ended.
void SpatialAdaptive::hand_out(double target, State& x, StepReport& report) {
  if (inner_.t <= target + rounding_in(target)) {
    if (report.status == Status::solved) inner_.t = target;
    x = inner_;
    report.joint_residual = joint_residual_, report.joint_rate = joint_rate_;
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
  const SpatialArc& arc = engine_.arc();
  between_.modes = arc.modes, between_.modes_changed();
  between_.rest_at(arc.rest);
  return flow_.extend(between_, arc);
}

/// At t within the crossing that ends the last inner step (crossing_state.h).
void SpatialAdaptive::within_crossing(double t, State& x) {
  const SpatialArc& arc = engine_.arc();
  x = before_;
  if (arc.length > 0 && fit()) flow_.within(arc, 1, x.q, x.v, push_), x.t = arc.start.t + arc.length;
  between_.open_all();
  move_within_crossing<Spatial>(t, inner_, left_.impulses, x);
}

/// At t within the last inner step: on the extension, or within a crossing. Impulses and work are those until then.
void SpatialAdaptive::hand_out_within(double t, State& x, StepReport& report) {
  const SpatialArc& arc = engine_.arc();
  const double s = t - arc.start.t;
  const bool inside = arc.length > 0 && s <= arc.length && (fitted_ || fit());
  fitted_ = inside;
  if (inside) {
    flow_.within(arc, s / arc.length, x.q, x.v, push_);
  } else {
    within_crossing(t, x);
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
  push_ -= handed_push_;
  for (const int c : between_.lasting()) {
    const auto i = static_cast<std::size_t>(c);
    double& normal = push_[3 * c];
    normal = std::clamp(normal, 0.0, std::max(0.0, left_.impulses[i].normal));
    const Tangents tangent{push_[3 * c + 1], push_[3 * c + 2]};
    impulses_[i].normal += normal, impulses_[i].tangent += tangent;
    left_.impulses[i].normal -= normal, left_.impulses[i].tangent += -1 * tangent;
  }
  if (measures_) *report.work += push_[push_.size() - 1], left_.work -= push_[push_.size() - 1];
  handed_push_ += push_;
}

}  // namespace orthant
