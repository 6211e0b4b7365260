#include <orthant/core/support/options.h>
#include <orthant/integrators/fixed_step/velocity_stepping.h>
#include <orthant/integrators/step/underflow.h>

namespace orthant {

template <class Space> VelocitySteppingOf<Space>::VelocitySteppingOf(const System& system, std::string_view name,
                                                                     const Capabilities& can, const Plan& plan)
    : IntegratorOf<Space>(system, name, can),
      terms_(system),
      v_new_(system.dof()),
      q_new_(system.coordinates()),
      plan_(plan),
      share_(plan.joints == Joints::symmetric ? 1 / plan.at : 1),
      basic_(system, plan.form == Form::reduced),
      projection_(system, plan.joints != Joints::none),
      impact_(system, plan.form),
      near_(system.cluster()),
      broad_phase_(system),
      sleep_(system, plan.sleep),
      tunnelling_(system),
      stuck_(system),
      formulation_(system, plan.form, plan.cone),
      shown_(&formulation_),
      geometric_(system),
      q_mid_(system.coordinates()),
      reach_(system.dof()),
      change_of_v_(system.dof()),
      from_(system.dof()),
      force_(system.dof()),
      rate_(system.joint_rows()),
      lambda_(system.joint_rows()) {
  formulation_.let_friction_win();
  if constexpr (kPlanar<Space>)
    for (const auto& f : system.scene().frictions)
      if (f.loaded()) joint_loads_.emplace_back(system, f.joint);
  if (!joint_loads_.empty()) loads_.resize(system.scene().frictions.size()), v_free_.resize(system.dof());
  if (geometric_.possible()) {
    added_.setZero(system.dof()), carried_.setZero(system.dof());
    if (plan.form == Form::full) joined_basic_.emplace(system);
  }
  if constexpr (!kPlanar<Space>) {
    gyroscopic_.setZero(system.dof());
    scale_ = system.mass().cwiseSqrt();
    frames_.reserve(static_cast<std::size_t>(system.bodies()) + 1);
    if (plan.form == Form::full && system.joint_rows() > 0) joined_basic_.emplace(system);
  }
  targets_.reserve(static_cast<std::size_t>(system.contacts()));
  taken_.reserve(2 * targets_.capacity());
}

template <class Space> StepReport VelocitySteppingOf<Space>::step(double h, Solver& solver, State& x) {
  StepReport report = StepReport::solved();
  formulation_.clear();
  shown_ = &formulation_;
  why_.clear();
  joined_.clear();
  formulation_.anchor(x.t, x.q, h), impact_.anchor(x.t, x.q, h);
  if (!free_flight(h, x, report)) return report;
  if (geometric_.possible() && !stiffen(h, x, report)) return report;
  measure(h, x);
  if (!find_pairs(h, x, report)) return report;
  sleep_.begin(x, terms_, v_new_);
  Step step{system_, h, x, terms_, targets_, v_new_, q_new_, joined_, near_, frames_};
  do {
    do close(step);
    while (sleep_.disturbed(terms_, targets_, v_new_));
    note_forces(terms_, v_new_, targets_);
    restrict_to_strikes(targets_);
    stuck_.choose(x, terms_, targets_);
    if (!impact_.strike(terms_, basic_, x.v, targets_, v_new_, solver, report)) {
      shown_ = &impact_.formulation();
      why_ = impact_.why();
      return report;
    }
    if (!solve_contacts(h, x, solver, report)) return report;
  } while (missed(step));
  report.note_rise(energy_rise(system_, terms_, targets_, v_new_, impulses_, kSameRows, &taken_), kInf);
  stuck_.note(terms_, impulses_, v_new_, system_);
  sleep_.hold(h, impulses_);
  if (geometric_.possible()) note_stiffness(h, x);
  if constexpr (!kPlanar<Space>) to_end_axes(system_, frames(h), x.v, v_new_);
  move<Space>(x.q, h * (plan_.theta * v_new_ + (1 - plan_.theta) * x.v), q_new_);
  if (!settle(x.t + h, report)) return report;
  report.passage = tunnelling_.find(x.q, q_new_, terms_);
  x.t += h;
  if constexpr (!kPlanar<Space>) drop_underflow(q_new_), drop_underflow(v_new_);
  x.q.swap(q_new_);
  x.v.swap(v_new_);
  sleep_.end(h, terms_, impulses_, x);
  if (!loads_.empty() || geometric_.possible()) last_q_ = x.q, last_v_ = x.v;
  stuck_.end(x);
  return report;
}

template <class Space> void VelocitySteppingOf<Space>::remember(CheckpointData& memory) {
  memory(formulation_, impact_, sleep_, taken_, loads_, carried_, last_q_, last_v_, stuck_);
  basic_.forget(), projection_.forget();
}

template <class Space> bool VelocitySteppingOf<Space>::free_flight(double h, const State& x, StepReport& report) {
  const double at = plan_.at;
  move<Space>(x.q, at * h * x.v, q_mid_);
  set_poses(system_, x.t + at * h, q_mid_, terms_.at);
  evaluate_forces(system_, x.t + at * h, x.v, terms_);
  evaluate_joint_rows(system_, terms_);
  stiffened_ = false;
  if (!factorize(h, report)) return false;
  if constexpr (kPlanar<Space>)
    fly(h, x);
  else if (!fly_gyroscopic(h, x, report))
    return false;
  return finite(v_new_) || fail(report, Status::numerical_error, "the motion is not finite");
}

template <class Space> StepFrames VelocitySteppingOf<Space>::frames(double h) const {
  return {h, plan_.at, plan_.theta};
}

template <class Space> bool VelocitySteppingOf<Space>::fly_gyroscopic([[maybe_unused]] double h,
                                                                      [[maybe_unused]] const State& x,
                                                                      [[maybe_unused]] StepReport& report) {
  if constexpr (!kPlanar<Space>) {
    constexpr int kPasses = 100;
    constexpr int kPlain = 8;             // before the acceleration
    constexpr double kSettled = 5e-16;    // of the largest velocity
    constexpr double kNearly = 1e-12;     // likewise: rounding where constraints magnify it
    constexpr int kLong = 30;             // passes after which rounding counts as magnified more:
    constexpr double kMagnified = 1e-10;  // by redundant joints (bricard: 2e-11)
    if (joined_basic_ && !joined_basic_->factorize(system_, terms_, h * h * plan_.at * plan_.theta, h * plan_.at))
      return fail(report, Status::numerical_error, "the basic system is not finite");
    const BasicSystem& joined = joined_basic_ ? *joined_basic_ : basic_;
    frames_.clear();
    for (const auto& pose : terms_.at.pose) frames_.push_back(pose.axes);
    applied_ = h * terms_.f, from_ = share_ * x.v, rates_ = share_ * terms_.joint_rate;
    v_new_ = x.v;
    gyroscopic_impulse(system_, frames(h), x.v, v_new_, gyroscopic_);
    for (int pass = 0;; ++pass) {
      force_ = applied_ + gyroscopic_;
      joined.solve_change(terms_.G, force_.data(), from_.data(), rates_.data(), change_of_v_.data(), lambda_.data());
      change_of_v_ += x.v;  // the image of v_new_
      // In the metric of M: the spin of slender bodies is known to no more digits than their momentum.
      const double change = (change_of_v_ - v_new_).cwiseProduct(scale_).template lpNorm<Eigen::Infinity>();
      const double size = change_of_v_.cwiseProduct(scale_).template lpNorm<Eigen::Infinity>();
      const bool done = change <= kSettled * size || (pass > kPlain && change <= kNearly * size) ||
                        (pass > kLong && change <= kMagnified * size);
      if (!done && pass == kPasses)
        return fail(report, Status::numerical_error,
                    "bodies turn too far in a step for their gyroscopic moments: a shorter step converges");
      if (pass < kPlain || done) {
        v_new_.swap(change_of_v_);
        anderson_.restart();
      } else {
        anderson_.next(v_new_, change_of_v_, scale_);
      }
      if (done) break;
      change_of_v_ = gyroscopic_;
      gyroscopic_impulse(system_, frames(h), x.v, v_new_, gyroscopic_);
      // In that metric the next velocity is no farther away than this: constraints only shorten it.
      if (pass < kPlain && (gyroscopic_ - change_of_v_).cwiseQuotient(scale_).norm() <= kSettled * size) break;
    }
    terms_.f = force_ / h;
    if (joined_basic_) fly(h, x);
  }
  return true;
}

/// The gyroscopic impulses once more, with what contacts make of the velocities. True: another v_free, in v_new_.
template <class Space>
bool VelocitySteppingOf<Space>::turn_more([[maybe_unused]] double h, [[maybe_unused]] const State& x) {
  if constexpr (!kPlanar<Space>) {
    constexpr double kSettled = 1e-14;  // of the impulses
    change_of_v_ = gyroscopic_;
    gyroscopic_impulse(system_, frames(h), x.v, v_new_, gyroscopic_);
    const double change = (gyroscopic_ - change_of_v_).template lpNorm<Eigen::Infinity>();
    const double all = std::max(applied_.template lpNorm<Eigen::Infinity>(),
                                system_.mass().cwiseProduct(v_new_).template lpNorm<Eigen::Infinity>());
    if (!(change > kSettled * all)) return false;
    terms_.f = (applied_ + gyroscopic_) / h;
    fly(h, x);
    return true;
  } else {
    return false;
  }
}

template <class Space> bool VelocitySteppingOf<Space>::factorize(double h, StepReport& report) {
  return basic_.factorize(system_, terms_, h * h * plan_.at * plan_.theta, h * plan_.at,
                          stiffened_ ? &added_ : nullptr) ||
         fail(report, Status::numerical_error, "the basic system is not finite");
}

template <class Space> bool VelocitySteppingOf<Space>::stiffen([[maybe_unused]] double h,
                                                               [[maybe_unused]] const State& x,
                                                               [[maybe_unused]] StepReport& report) {
  if constexpr (!kPlanar<Space>)
    return true;
  else {
    const double weight = h * h;
    const bool known = last_q_.size() > 0 && x.q == last_q_ && x.v == last_v_;
    added_.setZero();
    if (known) added_ = weight * carried_;
    bool counts = known && (added_.array() > system_.mass().array()).any();
    if (joined_basic_) {  // the reduced form has found them already
      if (!joined_basic_->factorize(system_, terms_, weight * plan_.at * plan_.theta, h * plan_.at))
        return fail(report, Status::numerical_error, "the basic system is not finite");
      force_ = h * terms_.f, from_ = share_ * x.v, rates_ = share_ * terms_.joint_rate;
      joined_basic_->solve_change(terms_.G, force_.data(), from_.data(), rates_.data(), change_of_v_.data(),
                                  lambda_.data());
    }
    if (geometric_.raise(terms_, lambda_.data(), h, weight, 1, added_)) counts = true;
    if (!counts || !geometric_.swings(joined_basic_ ? *joined_basic_ : basic_, added_, 1)) return true;
    stiffened_ = true;
    if (!factorize(h, report)) return false;
    fly(h, x);
    return finite(v_new_) || fail(report, Status::numerical_error, "the motion is not finite");
  }
}

template <class Space>
void VelocitySteppingOf<Space>::note_stiffness([[maybe_unused]] double h, [[maybe_unused]] const State& x) {
  if constexpr (kPlanar<Space>) {
    carried_.setZero();
    for (const RateTarget& w : targets_)
      if (w.approach < -kRestSpeed * w.law->unit - std::abs(w.free - w.approach)) return;  // an impact is no load
    if (plan_.form == Form::full || !targets_.empty() || !frictions_.empty()) {
      find_joint_impulses(h, x);
      geometric_.raise(terms_, lambda_.data(), h, 1, kInf, carried_);
    }
  }
}

template <class Space> void VelocitySteppingOf<Space>::fly(double h, const State& x) {
  force_ = h * terms_.f;
  change_joined(x.v, v_new_);
  v_new_ += x.v;
  if (plan_.form == Form::full)
    for (Index i = 0; i < rate_.size(); ++i)
      rate_[i] =
          share_ * terms_.joint_rate[i] - (share_ - 1) * apply(terms_.G[static_cast<std::size_t>(i)], x.v.data());
}

template <class Space>
void VelocitySteppingOf<Space>::change_joined(const Eigen::VectorXd& v, Eigen::VectorXd& change) {
  from_ = share_ * v;
  rate_ = share_ * terms_.joint_rate;
  basic_.solve_change(terms_.G, force_.data(), from_.data(), rate_.data(), change.data(), lambda_.data());
}

template <class Space> void VelocitySteppingOf<Space>::measure(double h, const State& x) {
  constexpr double kImpulses = 1e-8;  // of velocities
  if (plan_.parted > 0) force_ = system_.inverse_mass().cwiseProduct(terms_.f);
  const double unit = system_.length_unit();
  near_.measure([&](Index i) {
    const double forces = plan_.parted > 0 ? plan_.parted * h * h * largest_motion<Space>(force_, i, unit) : 0;
    return touching(largest_coordinate<Space>(x.q, i, unit)) + kImpulses * h * largest_motion<Space>(v_new_, i, unit) +
           forces;
  });
}

template <class Space> bool VelocitySteppingOf<Space>::find_pairs(double h, const State& x, StepReport& report) {
  if (!broad_phase_.any()) return true;
  double most = 2;  // gaps at either end of the step, and what rebounds and relaxed cones see ahead
  for (const ContactLaw& law : system_.laws()) most = std::max(most, 1 + law.mu);
  reach_ = most * h * (x.v.cwiseAbs() + v_new_.cwiseAbs());
  reach_.array() += 10 * near_.largest();  // what a scheme takes for closed may be open
  return broad_phase_.find(reach_, terms_) || fail(report, Status::numerical_error, broad_phase_.why());
}

template <class Space>
bool VelocitySteppingOf<Space>::solve_contacts(double h, const State& x, Solver& solver, StepReport& report) {
  constexpr int kPasses = 50;
  constexpr double kSameLoads = 1e-12;  // of the largest load
  const bool known = loads_.empty() || (last_q_.size() > 0 && x.q == last_q_ && x.v == last_v_);
  if (!known) std::fill(loads_.begin(), loads_.end(), 0.0), v_free_ = v_new_;
  for (int pass = 1;; ++pass) {
    formulation_.resist(h, loads_.empty() ? nullptr : &loads_);
    formulation_.formulate(terms_, basic_, targets_, v_new_, rate_);
    if (!formulation_.solve(solver, report, pool(), &terms_.closed)) {
      why_ = formulation_.contradiction();
      return false;
    }
    formulation_.advance(v_new_, impulses_);
    if constexpr (!kPlanar<Space>)
      for (int turn = 0; turn < kPasses && formulation_.size() > 0 && turn_more(h, x); ++turn) {
        formulation_.retarget(targets_, v_new_, rate_);
        if (!formulation_.solve(solver, report, pool(), &terms_.closed)) {
          why_ = formulation_.contradiction();
          return false;
        }
        formulation_.advance(v_new_, impulses_);
      }
    impact_.add_to(impulses_);
    for (std::size_t i = 0; i < frictions_.size(); ++i) frictions_[i] = formulation_.joint_friction(i);
    if (loads_.empty()) return true;
    const double change = note_loads(h, x);
    if (known || pass == kPasses || change <= kSameLoads * *std::max_element(loads_.begin(), loads_.end())) return true;
    v_new_ = v_free_;
  }
}

template <class Space> void VelocitySteppingOf<Space>::find_joint_impulses(double h, const State& x) {
  const auto& frictions = system_.scene().frictions;
  if (plan_.form == Form::full) {
    lambda_ = formulation_.solution().z.head(lambda_.size());
    impact_.add_joints_to(lambda_);
  } else {  // M̂ Δv = h f + Jᵀ z + Gᵀ Λ once more, with z known
    force_ = h * terms_.f;
    for (const auto& c : terms_.closed) {
      const Impulse& impulse = impulses_[static_cast<std::size_t>(c.contact)];
      apply_transposed(c.rows.normal, impulse.normal, force_.data());
      for (std::size_t i = 0; i < Space::kTangents; ++i)
        apply_transposed(row_of_tangent(c.rows, i), tangent_part(impulse.tangent, i), force_.data());
    }
    for (std::size_t i = 0; i < frictions.size(); ++i)
      apply_transposed(frictions[i].of.row(terms_.at), frictions_[i], force_.data());
    change_joined(x.v, change_of_v_);
  }
}

template <class Space> double VelocitySteppingOf<Space>::note_loads(double h, const State& x) {
  const auto& frictions = system_.scene().frictions;
  find_joint_impulses(h, x);
  double change = 0;
  auto joint = joint_loads_.begin();
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    if (!frictions[i].loaded()) continue;
    const double load = (joint++)->size(terms_.G, lambda_.data()) / h;
    change = std::max(change, std::abs(load - loads_[i]));
    loads_[i] = load;
  }
  return change;
}

template <class Space> bool VelocitySteppingOf<Space>::settle(double t, StepReport& report) {
  if (plan_.joints == Joints::none && rate_.size() > 0) {  // all that this asks of joints
    constexpr double kHold = 1e-6;                         // of 1 m/s + the velocities of a row's bodies
    for (Index i = 0; i < rate_.size(); ++i) rate_[i] = terms_.missing_rate(i, v_new_);
    report.joint_rate = rate_.lpNorm<Eigen::Infinity>();
    if (!(off_by(terms_, v_new_, rate_) <= kHold))
      return fail(report, Status::numerical_error,
                  "joints that contradict each other: rates are missed by " + detail::text_of(report.joint_rate));
  }
  report.joint_residual = projection_.position(t, terms_, q_new_, stiffened_ ? &added_ : nullptr);
  if (plan_.joints != Joints::none && !(report.joint_residual <= kJointsHold * terms_.unit) &&
      !(projection_.off(terms_, q_new_) <= kJointsHold))
    return fail(report, Status::numerical_error,
                "the projection onto the joints ends at " + detail::text_of(report.joint_residual) + " m");
  if (plan_.joints == Joints::symmetric) report.joint_rate = projection_.velocity(terms_, v_new_);
  evaluate_gaps(system_, terms_);
  gaps_ = terms_.gap;
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
  return (finite(q_new_) && finite(v_new_)) || fail(report, Status::numerical_error, "the motion is not finite");
}

template class VelocitySteppingOf<Planar>;
template class VelocitySteppingOf<Spatial>;

}  // namespace orthant
