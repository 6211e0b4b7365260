#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/rattle_linearization.h>
#include <orthant/integrators/derivatives/shared_friction.h>

#include <algorithm>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kSameRattle = 1e-8;  // of velocities: rounding, and what the position stage leaves

}  // namespace

RattleLinearization::RattleLinearization(const System& system, const RattleOptions& /*options*/)
    : system_(system),
      start_(system),
      end_(system),
      first_(system),
      second_(system),
      saddle_(system),
      slopes_(static_cast<std::size_t>(system.joint_rows())) {
  refuse_impact_laws(system.scene());
  if (!system.scene().collisions.empty())
    throw std::invalid_argument("derivatives of a step: collisions that are searched have none here");
  const Index dof = system.dof();
  for (auto* x : {&u_, &kick_, &free_, &pushed_, &new_, &none_, &force_, &x_, &y_}) x->setZero(dof);
  for (auto* x : {&lambda_1_, &lambda_free_, &lambda_push_, &none_of_joints_, &unused_, &joints_, &rate_})
    x->setZero(system.joint_rows());
}

bool RattleLinearization::begins(int contact) const {
  return !begun_.empty() && begun_[at(contact)] != 0 && !system_.law(contact).frictional();
}

// Contacts that friction begins at, and that do not slip.
void RattleLinearization::note_rest(Stage& stage) {
  const double time = &stage == &position_ ? step_->h : 1;
  for (std::size_t k = 0; k < stage.tangent.size(); ++k) {
    const int contact = step_->contacts[k].contact;
    if (stage.tangent[k] < 0 || !begins(contact)) continue;
    double& slip = stage.w[stage.tangent[k]];
    if (std::abs(slip) > time * kStickSpeed * system_.law(contact).unit) continue;
    slip = 0;
    if (stage.z[stage.normal[k]] > 0) degenerate_.push_back(contact);
  }
}

void RattleLinearization::number(Stage& stage, bool velocity) {
  const RattleTrace& step = *step_;
  stage.normal.clear(), stage.tangent.clear(), stage.mu_of.clear();
  stage.push.clear(), stage.hold.clear(), stage.problem.friction.clear(), stage.sensitivity.clear();
  stage.rows = 0;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const RattleTrace::Contact& c = step.contacts[k];
    const RattleTrace::Stage& of = velocity ? c.velocity : c.position;
    const ContactRows &there = end_.closed[k].rows, &here = velocity ? there : start_.closed[k].rows;
    stage.normal.push_back(of.has_normal ? stage.rows++ : -1);
    const bool rubs = of.has_tangent || (of.has_normal && begins(c.contact));
    stage.tangent.push_back(rubs ? stage.rows++ : -1);
    if (of.has_normal) stage.push.push_back(here.normal), stage.hold.push_back(there.normal);
    if (!rubs) continue;
    stage.push.push_back(here.tangent), stage.hold.push_back(here.tangent);
    stage.problem.friction.push_back({stage.normal.back(), stage.tangent.back(), 1, of.mu});
    stage.mu_of.emplace_back(c.contact, of.is_static);
  }
  stage.first_friction = stage.rows;
  for (const JointFriction& f : system_.scene().frictions) {
    const Row row = f.of.row(velocity ? end_.at : start_.at);
    stage.push.push_back(row), stage.hold.push_back(row);
    ++stage.rows;
  }
  stage.z = Eigen::VectorXd::Zero(stage.rows), stage.w = stage.z;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const RattleTrace::Stage& of = velocity ? step.contacts[k].velocity : step.contacts[k].position;
    if (of.has_normal) stage.z[stage.normal[k]] = of.normal;
    if (of.has_tangent) stage.z[stage.tangent[k]] = of.tangent;
  }
  stage.z.tail(stage.rows - stage.first_friction) = velocity ? step.friction_velocity : step.friction_position;
}

void RattleLinearization::evaluate() {
  const RattleTrace& step = *step_;
  const State &x = step.before, &y = step.after;
  const double h = step.h;
  u_ = (y.q - x.q) / h;
  set_poses(system_, x.t, x.q, start_.at);
  evaluate_forces(system_, x.t, x.v, start_);
  evaluate_joint_rows(system_, start_);
  set_poses(system_, x.t + h, y.q, end_.at);
  evaluate_forces(system_, x.t + h, u_, end_);
  evaluate_joint_rows(system_, end_);
  start_.closed.clear(), end_.closed.clear();
  for (const RattleTrace::Contact& c : step.contacts) {
    add_closed_as(system_, c.contact, end_, start_), add_closed(system_, c.contact, end_);
    add_closed(system_, c.contact, start_);
    const ContactRows there = start_.closed.back().rows;
    start_.closed.pop_back();
    const ContactRows& rows = start_.closed.back().rows;
    if (there.normal.ja != rows.normal.ja || there.normal.jb != rows.normal.jb)
      throw std::runtime_error("derivatives of a step: at t = " + detail::text_of(x.t) +
                               " s a contact of polygons moves to other points within the step");
  }
  if (!first_.factorize(system_, start_, 0, h / 2) || !second_.factorize(system_, end_, 0, 0))
    throw std::runtime_error("derivatives of a step: not finite");
}

// v', v⁺ and their impulses of the joints. Throws where they are not those of the step.
void RattleLinearization::find_velocities() {
  const RattleTrace& step = *step_;
  const State &x = step.before, &y = step.after;
  const double h = step.h;
  force_ = h / 2 * start_.f;
  for (Index i = 0; i < position_.rows; ++i) apply_transposed(position_.push[at(i)], position_.z[i] / h, force_.data());
  for (Index i = 0; i < rate_.size(); ++i) rate_[i] = apply(start_.G[at(i)], u_.data());
  first_.solve_change(start_.G, force_.data(), x.v.data(), rate_.data(), kick_.data(), lambda_1_.data());
  const double rounding = 0x1p-48 * y.q.lpNorm<Eigen::Infinity>() / h;
  double missed = (x.v + kick_ - u_).lpNorm<Eigen::Infinity>() - rounding;
  kick_ = u_ - x.v;
  force_ = h / 2 * end_.f;
  for (Index i = 0; i < position_.rows; ++i) apply_transposed(carry_[at(i)], -position_.z[i] / h, force_.data());
  second_.solve_change(end_.G, force_.data(), u_.data(), end_.joint_rate.data(), free_.data(), lambda_free_.data());
  free_ += u_;
  pushed_.setZero(), lambda_push_.setZero();
  if (velocity_.rows > 0) {
    force_.setZero();
    for (Index i = 0; i < velocity_.rows; ++i) apply_transposed(velocity_.push[at(i)], velocity_.z[i], force_.data());
    second_.solve(force_.data(), none_of_joints_.data(), pushed_.data(), lambda_push_.data());
  }
  new_ = free_ + pushed_;
  missed = std::max(missed, (new_ - y.v).lpNorm<Eigen::Infinity>() - rounding);
  missed /= 1 + std::max(y.v.lpNorm<Eigen::Infinity>(), x.v.lpNorm<Eigen::Infinity>());
  if (!(missed <= kSameRattle))
    throw std::runtime_error("derivatives of a step: at t = " + detail::text_of(x.t) +
                             " s the step is not the plain one of rattle, by " + detail::text_of(missed) +
                             ": such a step has no derivative here; a smaller one may avoid it");
}

double RattleLinearization::speed_at_surface(std::size_t k, double& square) const {
  const Row& row = end_.closed[k].rows.normal;
  const double before = apply(row, step_->before.v.data());
  square = before * before + 2 * (apply(row, free_.data()) - before) * apply(row, u_.data());
  return std::sqrt(std::max(0.0, square));
}

void RattleLinearization::solve_stage(Stage& stage, double bound) {
  if (stage.rows == 0) return;
  Eigen::MatrixXd A(stage.rows, stage.rows);
  for (Index j = 0; j < stage.rows; ++j)
    for (Index i = 0; i < stage.rows; ++i) A(i, j) = apply(stage.hold[at(i)], stage.unit.col(j).data());
  note_rest(stage);
  Lcp& problem = stage.problem;
  problem.lo = Eigen::VectorXd::Constant(stage.rows, -kInf), problem.hi = Eigen::VectorXd::Constant(stage.rows, kInf);
  for (const Index normal : stage.normal)
    if (normal >= 0) problem.lo[normal] = 0;
  for (Index i = stage.first_friction; i < stage.rows; ++i) {
    const double most = bound * system_.scene().frictions[at(i - stage.first_friction)].bound;
    problem.lo[i] = -most, problem.hi[i] = most;
  }
  std::vector<double> stick;
  for (const auto& [contact, is_static] : stage.mu_of)
    stick.push_back((&stage == &position_ ? step_->h : 1) * kStickSpeed * system_.law(contact).unit);
  Solution solution;
  solution.z = stage.z;
  share_friction(problem, stage.push, system_.dof(), stage.w, stick, solution.z);
  const auto hold_inside = [&](Index row, double most) {  // rates there are rounding
    if (std::abs(solution.z[row]) < (1 - kAtFrictionBound) * most) stage.w[row] = 0;
  };
  for (const Friction& f : problem.friction) hold_inside(f.first, f.mu * stage.z[f.normal]);
  for (Index i = stage.first_friction; i < stage.rows; ++i) hold_inside(i, problem.hi[i]);
  problem.b = stage.w - A * solution.z;
  problem.A = DenseMatrix(A);
  judge_.certify(problem, 1e-8, Claim::candidate, solution);
  if (!has_answer(solution.status))
    throw std::runtime_error("derivatives of a step: at t = " + detail::text_of(step_->before.t) +
                             " s its contacts are not solved");
  stage.sensitivity.set_up(problem, solution);
  for (const WeaklyActive& row : stage.sensitivity.weakly_active()) {
    if (row.row >= stage.first_friction) spent_.push_back(static_cast<int>(row.row - stage.first_friction));
    for (std::size_t k = 0; k < stage.normal.size(); ++k)
      if (stage.normal[k] == row.row || stage.tangent[k] == row.row) degenerate_.push_back(step_->contacts[k].contact);
  }
}

// w₁ and its exact matrix.
void RattleLinearization::find_positions() {
  const double h = step_->h;
  Stage& stage = position_;
  stage.unit.resize(system_.dof(), stage.rows);
  for (Index i = 0; i < stage.rows; ++i) {
    force_.setZero();
    apply_transposed(stage.push[at(i)], 1, force_.data());
    saddle_.solve(force_, nullptr, x_);
    stage.unit.col(i) = x_;
    stage.w[i] = h * apply(stage.hold[at(i)], u_.data());
  }
  for (std::size_t k = 0; k < stage.normal.size(); ++k) {
    const int contact = step_->contacts[k].contact;
    if (const Index i = stage.normal[k]; i >= 0)
      stage.w[i] = stage.z[i] > 0 ? 0 : gap_of(system_, {}, contact, end_.at);
    if (const Index i = stage.tangent[k]; i >= 0) stage.w[i] -= h * system_.law(contact).belt;
  }
  solve_stage(stage, h * h / 2);
}

void RattleLinearization::set_up(const RattleTrace& step) {
  step_ = &step;
  const Index dof = system_.dof(), joints = system_.joint_rows();
  degenerate_.clear(), spent_.clear(), consistent_ = true, any_at_surface_ = false;
  evaluate();
  number(position_, false), number(velocity_, true);
  carry_ = position_.push;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    any_at_surface_ = any_at_surface_ || step.contacts[k].at_surface;
    if (step.contacts[k].velocity.has_normal && !step.contacts[k].position.has_normal)
      degenerate_.push_back(step.contacts[k].contact);  // it touches, within rounding
    const ContactRows& rows = (step.contacts[k].rebounds ? start_ : end_).closed[k].rows;
    if (position_.normal[k] >= 0) carry_[at(position_.normal[k])] = rows.normal;
    if (position_.tangent[k] >= 0) carry_[at(position_.tangent[k])] = rows.tangent;
  }
  for (Index i = position_.first_friction; i < position_.rows; ++i)
    carry_[at(i)] = velocity_.push[at(velocity_.first_friction + i - position_.first_friction)];
  find_velocities();
  saddle_.set_up(start_, end_.G, step.h / 2, first_);
  find_positions();
  velocity_.unit.resize(dof, velocity_.rows);
  for (Index i = 0; i < velocity_.rows; ++i) {
    second_.solve_row(velocity_.push[at(i)], velocity_.unit.col(i).data());
    velocity_.w[i] = apply(velocity_.hold[at(i)], new_.data());
  }
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const ContactLaw& law = system_.law(step.contacts[k].contact);
    const ContactRows& rows = start_.closed[k].rows;
    double square = 0;
    if (const Index i = velocity_.normal[k]; i >= 0) {
      const double back = step.contacts[k].at_surface ? -law.e * speed_at_surface(k, square)
                                                      : law.e * apply(rows.normal, step.before.v.data());
      velocity_.w[i] = velocity_.z[i] > 0 ? 0 : velocity_.w[i] + back;
    }
    const Index i = velocity_.tangent[k];
    if (i >= 0 && step.contacts[k].strikes)
      velocity_.w[i] += law.e_t * (apply(rows.tangent, step.before.v.data()) - law.belt);
    if (i >= 0) velocity_.w[i] -= law.belt;
  }
  solve_stage(velocity_, step.h);
  std::sort(degenerate_.begin(), degenerate_.end());
  degenerate_.erase(std::unique(degenerate_.begin(), degenerate_.end()), degenerate_.end());
  at_.r2 = dof, at_.w1 = at_.r2 + joints;
  at_.r4 = at_.w1 + 2 * position_.rows + std::ssize(position_.mu_of), at_.r5 = at_.r4 + dof;
  at_.r7 = at_.r5 + joints, at_.r8 = at_.r7 + dof, at_.w2 = at_.r8 + joints;
  at_.size = at_.w2 + 2 * velocity_.rows + std::ssize(velocity_.mu_of);
  linearize();
}

// ż of a stage, its w at fixed z being those of rho_ and of `rates`.
const Eigen::VectorXd& RattleLinearization::tangent_of(Stage& stage, Index place, const Eigen::VectorXd& rates) {
  const Index n = stage.rows;
  double* const w = rho_.data() + place;
  for (Index i = 0; i < n; ++i) w[i] += rates[i];
  z_dot_.resize(n);
  const double* const hi = stage.first_friction < n ? w + n : nullptr;
  consistent_ = stage.sensitivity.tangent(w, hi, w + 2 * n, 1, z_dot_.data()) && consistent_;
  return z_dot_;
}

void RattleLinearization::push(const std::vector<StepPart>& parameters, DirectionBlock& q, DirectionBlock& v,
                               std::vector<ImpulseChange>* impulses) {
  for (Index j = 0; j < q.cols(); ++j) {
    one_q_ = q.col(j), one_v_ = v.col(j);
    push_one(parameters[at(j)], one_q_.data(), one_v_.data(), impulses != nullptr ? &(*impulses)[at(j)] : nullptr);
    q.col(j) = one_q_, v.col(j) = one_v_;
  }
}

void RattleLinearization::push_one(const StepPart& parameter, double* q, double* v, ImpulseChange* impulses) {
  const Index dof = system_.dof(), joints = system_.joint_rows();
  const double h = step_->h;
  Eigen::Map<Eigen::VectorXd> dq(q, dof), dv(v, dof);
  rho_.setZero(at_.size);
  for (const auto& [place, value] : parameter.step) rho_[place] += value;
  orthant::apply(of_q_, q, rho_.data());
  orthant::apply(of_v_, v, rho_.data());
  rho_.head(dof) -= system_.mass().cwiseProduct(dv);

  force_ = -rho_.head(dof), joints_ = rho_.segment(at_.r2, joints) / -h;
  saddle_.solve(force_, joints_.data(), x_);
  if (position_.rows > 0) {
    y_.resize(position_.rows);
    for (Index i = 0; i < position_.rows; ++i) y_[i] = h * apply(position_.hold[at(i)], x_.data());
    const Eigen::VectorXd z = tangent_of(position_, at_.w1, y_) / h;
    x_ += position_.unit * z;
    for (Index i = 0; i < position_.rows; ++i) apply_transposed(carry_[at(i)], z[i], rho_.data() + at_.r4);
  }
  dq += h * x_;  // x_ is u̇
  orthant::apply(of_u_, x_.data(), rho_.data());
  rho_.segment(at_.r4, dof) -= system_.mass().cwiseProduct(x_);
  orthant::apply(of_end_, q, rho_.data());
  if (any_at_surface_) {
    force_ = -rho_.segment(at_.r4, dof), joints_ = -rho_.segment(at_.r5, joints);
    second_.solve(force_.data(), joints_.data(), x_.data(), unused_.data());
    orthant::apply(of_free_, x_.data(), rho_.data());
  }
  force_ = -rho_.segment(at_.r4, dof) - rho_.segment(at_.r7, dof);
  joints_ = -rho_.segment(at_.r5, joints) - rho_.segment(at_.r8, joints);
  second_.solve(force_.data(), joints_.data(), v, unused_.data());
  if (impulses != nullptr) impulses->clear(system_);
  if (velocity_.rows == 0) return;
  y_.resize(velocity_.rows);
  for (Index i = 0; i < velocity_.rows; ++i) y_[i] = apply(velocity_.hold[at(i)], v);
  const Eigen::VectorXd z = tangent_of(velocity_, at_.w2, y_);
  dv += velocity_.unit * z;
  for (std::size_t k = 0; k < velocity_.normal.size() && impulses != nullptr; ++k) {
    if (velocity_.normal[k] >= 0) impulses->normal[step_->contacts[k].contact] = z[velocity_.normal[k]];
    if (velocity_.tangent[k] >= 0) impulses->tangent[step_->contacts[k].contact] = z[velocity_.tangent[k]];
  }
  if (impulses != nullptr) impulses->friction = z.tail(velocity_.rows - velocity_.first_friction);
}

// The adjoint of w at fixed z; those of bounds and μ behind it.
Eigen::VectorXd RattleLinearization::adjoint_of(Stage& stage, Index place, const Vector& of_z) {
  double* const w = by_.data() + place;
  consistent_ = stage.sensitivity.adjoint(of_z, w, w + stage.rows, w + 2 * stage.rows) && consistent_;
  return by_.segment(place, stage.rows);
}

void RattleLinearization::pull(double* q, double* v, const ImpulseChange* impulses) {
  const Index dof = system_.dof(), joints = system_.joint_rows();
  const double h = step_->h;
  Eigen::Map<Eigen::VectorXd> of_q(q, dof), of_v(v, dof);
  by_.setZero(at_.size);
  y_ = of_v;
  if (velocity_.rows > 0) {
    Vector of_z = velocity_.unit.transpose() * of_v;
    for (std::size_t k = 0; k < velocity_.normal.size() && impulses != nullptr; ++k) {
      if (velocity_.normal[k] >= 0) of_z[velocity_.normal[k]] += impulses->normal[step_->contacts[k].contact];
      if (velocity_.tangent[k] >= 0) of_z[velocity_.tangent[k]] += impulses->tangent[step_->contacts[k].contact];
    }
    if (impulses != nullptr) of_z.tail(velocity_.rows - velocity_.first_friction) += impulses->friction;
    const Eigen::VectorXd beta = adjoint_of(velocity_, at_.w2, of_z);
    for (Index i = 0; i < velocity_.rows; ++i) apply_transposed(velocity_.hold[at(i)], beta[i], y_.data());
  }
  second_.solve(y_.data(), none_of_joints_.data(), x_.data(), joints_.data());
  for (const Index place : {at_.r4, at_.r7}) by_.segment(place, dof) = -x_;
  for (const Index place : {at_.r5, at_.r8}) by_.segment(place, joints) = joints_;
  if (any_at_surface_) {
    y_.setZero();
    apply_transposed(of_free_, by_.data(), y_.data());
    second_.solve(y_.data(), none_of_joints_.data(), x_.data(), joints_.data());
    by_.segment(at_.r4, dof) -= x_, by_.segment(at_.r5, joints) += joints_;
  }
  apply_transposed(of_end_, by_.data(), q);
  y_ = h * of_q - system_.mass().cwiseProduct(by_.segment(at_.r4, dof));  // of u
  apply_transposed(of_u_, by_.data(), y_.data());
  if (position_.rows > 0) {
    Vector of_z = position_.unit.transpose() * y_ / h;
    for (Index i = 0; i < position_.rows; ++i) of_z[i] += apply(carry_[at(i)], by_.data() + at_.r4) / h;
    const Eigen::VectorXd beta = adjoint_of(position_, at_.w1, of_z);
    for (Index i = 0; i < position_.rows; ++i) apply_transposed(position_.hold[at(i)], h * beta[i], y_.data());
  }
  saddle_.solve_adjoint(y_, x_, joints_);
  by_.head(dof) = -x_;
  by_.segment(at_.r2, joints) = joints_ / -h;
  of_v = -system_.mass().cwiseProduct(by_.head(dof));
  apply_transposed(of_q_, by_.data(), q);
  apply_transposed(of_v_, by_.data(), v);
}

}  // namespace orthant
