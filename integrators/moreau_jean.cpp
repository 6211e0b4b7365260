#include <orthant/integrators/moreau_jean.h>

namespace orthant {

MoreauJean::MoreauJean(const System& system, const Options& options)
    : Integrator(system),
      options_(options),
      terms_(system),
      basic_(system, options.form == Form::reduced),
      projection_(system, options.joints != Joints::none),
      formulation_(system, options.form),
      q_mid_(system.dof()),
      q_new_(system.dof()),
      v_new_(system.dof()),
      force_(system.dof()),
      rate_(system.joint_rows()),
      lambda_(system.joint_rows()) {}

StepReport MoreauJean::step(double h, Solver& solver, State& x) {
  StepReport report;
  formulation_.clear();
  if (!free_flight(h, x)) {
    report.status = Status::numerical_error;
    return report;
  }
  evaluate_gaps(system_, terms_);
  evaluate_closed(system_, 0.0, terms_);
  formulation_.formulate(terms_, basic_, x.v, v_new_, rate_);
  if (problem().size() > 0) {
    solver.solve(problem(), solution_, Start::warm);
    if (!report.note(problem(), solution_)) return report;
    if (formulation_.hold(terms_, solution_)) {
      solver.solve(problem(), solution_, Start::warm);
      if (!report.note(problem(), solution_)) return report;
    }
  }
  formulation_.advance(terms_, solution_.z, v_new_, impulses_);
  q_new_ = x.q + h * (options_.theta * v_new_ + (1 - options_.theta) * x.v);
  if (!settle(report)) {
    report.status = Status::numerical_error;
    return report;
  }
  x.t += h;
  x.q.swap(q_new_);
  x.v.swap(v_new_);
  return report;
}

bool MoreauJean::free_flight(double h, const State& x) {
  const double theta = options_.theta;
  q_mid_ = x.q + theta * h * x.v;
  set_poses(system_, q_mid_, terms_.at);
  evaluate_forces(system_, x.t + theta * h, x.v, terms_);
  evaluate_joint_rows(system_, terms_);
  if (!basic_.factorize(system_, terms_, h * h * theta * theta, h * theta)) return false;

  // Wanted G v⁺: 0, or such that the mean velocity of the step satisfies the joints.
  const double keep = options_.joints == Joints::symmetric ? 1 - 1 / theta : 0;
  for (Index i = 0; i < rate_.size(); ++i) rate_[i] = keep * apply(terms_.G[static_cast<std::size_t>(i)], x.v.data());
  force_ = h * terms_.f;
  if (basic_.joint_rows() > 0)
    for (Index i = 0; i < rate_.size(); ++i)
      lambda_[i] = rate_[i] - apply(terms_.G[static_cast<std::size_t>(i)], x.v.data());
  basic_.solve(force_.data(), lambda_.data(), v_new_.data(), lambda_.data());
  v_new_ += x.v;
  return v_new_.allFinite();
}

bool MoreauJean::settle(StepReport& report) {
  report.joint_residual = projection_.position(terms_, q_new_);
  if (!(report.joint_residual < kInf)) return false;
  if (options_.joints == Joints::symmetric) report.joint_rate = projection_.velocity(terms_, v_new_);
  evaluate_gaps(system_, terms_);
  gaps_ = terms_.gap;
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
  return q_new_.allFinite() && v_new_.allFinite();
}

}  // namespace orthant
