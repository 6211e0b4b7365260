#include <orthant/integrators/fixed_step/rattle.h>
#include <algorithm>
#include <cmath>

namespace orthant {

template <class Space> RattleOf<Space>::RattleOf(const System& system, const Options& /*options*/)
    : TwoLevelOf<Space>(system, kName, kCan), path_(system.dof()), v_(system.dof()), wanted_rate_(system.joint_rows()) {
  if constexpr (!kPlanar<Space>) {
    half_force_.setZero(system.dof()), turning_.setZero(system.dof()), next_.setZero(system.dof());
    scale_ = system.inverse_mass().cwiseSqrt();
    carried_.resize(static_cast<std::size_t>(system.contacts()));
  }
}

template <class Space> StepReport RattleOf<Space>::step(double h, Solver& solver, State& x) {
  StepReport report = StepReport::solved();
  begin();
  if (!half_kick(h, x, report) || !reach_turning(h, x, solver, report)) return report;
  v_ = path_ / h;
  note_carried();
  hand_over(x);
  if (!other_half(h, x, report) || !strike(h, v_, solver, report)) return report;
  arrive(h, v_, x, report);
  last_ = x.q;
  factorized_there_ = report.status == Status::solved && system_.scene().springs.empty();
  return report;
}

template <class Space> bool RattleOf<Space>::half_kick(double h, const State& x, StepReport& report) {
  const bool factorized = factorized_there_ && x.q == last_;  // where the step before ended: nothing to do again
  factorized_there_ = false;
  if (factorized)
    std::swap(start_, end_);
  else
    set_poses(system_, x.t, x.q, start_.at);
  set_twists(system_, x.v, start_.at);
  evaluate_forces(system_, x.t, x.v, start_);
  if (last_.size() == 0 || x.q != last_) stiffened_ = false;
  if (!factorized && !factorize(start_, 0, h / 2, report)) return false;
  // A guess at G u that leaves Φ = O(h³): u is tangent half a step ahead. Any other would end at the same q⁺.
  start_.closed.clear();
  evaluate_biases(system_, start_);
  wanted_rate_ = start_.joint_rate - h / 2 * start_.joint_bias;
  force_ = h / 2 * start_.f;
  if constexpr (kPlanar<Space>) {
    predict(h, x);
    if (geometric_.possible()) {
      const bool before = stiffened_;
      added_.setZero();
      stiffened_ = geometric_.raise(start_, lambda_.data(), h / 2, h * h, 1, added_) &&
                   geometric_.swings(basic_, added_, before ? 0.5 : 1);
      if (stiffened_ || before) {
        if (!factorize(start_, 0, h / 2, report)) return false;
        predict(h, x);
      }
    }
    return true;
  } else {
    return predict_turning(h, x, report);
  }
}

template <class Space> void RattleOf<Space>::predict(double h, const State& x) {
  basic_.solve_change(start_.G, force_.data(), x.v.data(), wanted_rate_.data(), path_.data(), lambda_.data());
  path_ = h * (x.v + path_);
}

template <class Space> bool RattleOf<Space>::turn_again([[maybe_unused]] double h, [[maybe_unused]] int pass) {
  if constexpr (!kPlanar<Space>) {
    constexpr int kPlain = 8;           // passes before the acceleration
    constexpr double kSettled = 5e-16;  // of the momenta, over √M
    constexpr double kNearly = 1e-12;   // likewise, where constraints magnify rounding
    v_ = path_ / h;
    fits_ = half_turning_impulse(system_, h, v_, Half::first, next_);
    const double change = (next_ - turning_).cwiseProduct(scale_).template lpNorm<Eigen::Infinity>();
    const double size = v_.cwiseQuotient(scale_).template lpNorm<Eigen::Infinity>();
    const bool same = change <= kSettled * size || (pass > kPlain && change <= kNearly * size);
    if (same) return true;
    if (pass < kPlain) {
      turning_.swap(next_);
      anderson_.restart();
    } else {
      anderson_.next(turning_, next_, scale_);
    }
    force_ = half_force_ + turning_;
    return false;
  } else {
    return true;
  }
}

template <class Space> bool RattleOf<Space>::check_turn(bool found, StepReport& report) {
  return (found && fits_) ||
         fail(report, Status::numerical_error,
              "bodies turn too far in a step for their gyroscopic moments: a shorter step converges");
}

template <class Space> bool RattleOf<Space>::predict_turning(double h, const State& x, StepReport& report) {
  constexpr int kPasses = 100;
  half_force_ = force_;
  if constexpr (!kPlanar<Space>) half_turning_impulse(system_, h, x.v, Half::first, turning_);
  force_ += turning_;
  int pass = 0;
  do predict(h, x);
  while (!turn_again(h, pass) && ++pass < kPasses);
  return check_turn(pass < kPasses, report);
}

template <class Space>
bool RattleOf<Space>::reach_turning(double h, const State& x, Solver& solver, StepReport& report) {
  if constexpr (kPlanar<Space>) {
    return reach(h, x, path_, solver, report);
  } else {
    constexpr int kPasses = 100;
    for (int pass = 0; pass < kPasses; ++pass) {
      if (!reach(h, x, path_, solver, report)) return false;
      if (turn_again(h, pass)) return check_turn(true, report);
      predict(h, x);
    }
    return check_turn(false, report);
  }
}

template <class Space> void RattleOf<Space>::note_carried() {
  if constexpr (!kPlanar<Space>) {
    std::ranges::fill(carried_, Vector3d(0, 0, 0));  // contacts that touch at the end had no rows, maybe
    for (const ClosedContact& c : start_.closed) {
      const auto contact = static_cast<std::size_t>(c.contact);
      const Tangents& carried = impulses_[contact].tangent;
      carried_[contact] = carried.first * spatial::direction_of(c.rows.tangents[0]) +
                          carried.second * spatial::direction_of(c.rows.tangents[1]);
    }
  }
}

template <class Space> bool RattleOf<Space>::rebounds([[maybe_unused]] std::size_t k, [[maybe_unused]] double h,
                                                      [[maybe_unused]] const State& x) const {
  if constexpr (kPlanar<Space>) {
    const ContactLaw& law = system_.law(start_.closed[k].contact);
    const Row& row = start_.closed[k].rows.normal;
    if (!(law.e > 0) || (row.a >= 0 && row.b >= 0)) return false;
    double by_forces = 0;
    each_entry(row, [&](Index i, double entry) { by_forces += entry * start_.f[i] * system_.inverse_mass()[i]; });
    return -apply(row, x.v.data()) > kRestSpeed * law.unit + h * std::abs(by_forces);
  } else {
    return false;
  }
}

template <class Space> bool RattleOf<Space>::other_half(double h, const State& x, StepReport& report) {
  evaluate_forces(system_, x.t + h, v_, end_);
  if (!factorize(end_, 0, 0, report)) return false;
  force_ = h / 2 * end_.f;
  if constexpr (!kPlanar<Space>) {
    half_turning_impulse(system_, h, v_, Half::second, next_);
    force_ += next_;
  }
  for (std::size_t k = 0; k < end_.closed.size(); ++k) {
    const ClosedContact& c = rebounds(k, h, x) ? start_.closed[k] : end_.closed[k];  // see the header
    const Impulse& carried = impulses_[static_cast<std::size_t>(c.contact)];         // [kg m]
    apply_transposed(c.rows.normal, -carried.normal / h, force_.data());
    if constexpr (kPlanar<Space>)
      apply_transposed(c.rows.tangent, -carried.tangent / h, force_.data());
    else
      for (const auto& tangent : c.rows.tangents) {
        const Vector3d t = spatial::direction_of(tangent),
                       &carried_there = carried_[static_cast<std::size_t>(c.contact)];
        if (!t.isZero(0)) apply_transposed(tangent, -carried_there.dot(t) / t.squaredNorm() / h, force_.data());
      }
  }
  for (std::size_t i = 0; i < system_.scene().frictions.size(); ++i)
    apply_transposed(system_.scene().frictions[i].of.row(end_.at), -friction_carried(i) / h, force_.data());
  basic_.solve_change(end_.G, force_.data(), v_.data(), end_.joint_rate.data(), path_.data(), lambda_.data());
  v_ += path_;
  return true;
}

template class RattleOf<Planar>;
template class RattleOf<Spatial>;

}  // namespace orthant
