#include <orthant/integrators/fixed_step/rattle.h>

namespace orthant {

Rattle::Rattle(const System& system, const Options& /*options*/)
    : TwoLevel(system, kName, kCan), path_(system.dof()), v_(system.dof()) {}

StepReport Rattle::step(double h, Solver& solver, State& x) {
  StepReport report;
  begin();
  if (!half_kick(h, x, report) || !reach(h, x, path_, solver, report)) return report;
  v_ = path_ / h;
  hand_over(x);
  if (!other_half(h, x, report) || !strike(v_, solver, report)) return report;
  arrive(h, v_, x, report);
  last_ = x.q;
  factorized_there_ = report.status == Status::solved && system_.scene().springs.empty();
  return report;
}

bool Rattle::half_kick(double h, const State& x, StepReport& report) {
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
  rate_ = start_.joint_rate - h / 2 * start_.joint_bias;
  force_ = h / 2 * start_.f;
  basic_.solve_change(start_.G, force_.data(), x.v.data(), rate_.data(), path_.data(), lambda_.data());
  if (geometric_.possible()) {
    const bool before = stiffened_;
    added_.setZero();
    stiffened_ = geometric_.raise(start_, lambda_.data(), h / 2, h * h, 1, added_) &&
                 geometric_.swings(basic_, added_, before ? 0.5 : 1);
    if (stiffened_ || before) {
      if (!factorize(start_, 0, h / 2, report)) return false;
      basic_.solve_change(start_.G, force_.data(), x.v.data(), rate_.data(), path_.data(), lambda_.data());
    }
  }
  path_ = h * (x.v + path_);
  return true;
}

bool Rattle::other_half(double h, const State& x, StepReport& report) {
  evaluate_forces(system_, x.t + h, v_, end_);
  if (!factorize(end_, 0, 0, report)) return false;
  force_ = h / 2 * end_.f;
  for (const ClosedContact& c : end_.closed) {
    const Impulse& carried = impulses_[static_cast<std::size_t>(c.contact)];  // [kg m]
    apply_transposed(c.rows.normal, -carried.normal / h, force_.data());
    apply_transposed(c.rows.tangent, -carried.tangent / h, force_.data());
  }
  for (std::size_t i = 0; i < system_.scene().frictions.size(); ++i)
    apply_transposed(system_.scene().frictions[i].of.row(end_.at), -friction_carried(i) / h, force_.data());
  basic_.solve_change(end_.G, force_.data(), v_.data(), end_.joint_rate.data(), path_.data(), lambda_.data());
  v_ += path_;
  return true;
}

}  // namespace orthant
