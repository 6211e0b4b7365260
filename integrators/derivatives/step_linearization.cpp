#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/shared_friction.h>
#include <orthant/integrators/derivatives/step_linearization.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kSameStep = 1e-8;  // of x⁺: rounding, and what the projections leave

}  // namespace

void refuse_overflow(bool finite, double t) {
  if (!finite)
    throw std::runtime_error(
        "derivatives of a run: in the step at t = " + detail::text_of(t) +
        " s they exceed the range of numbers: the motion is so unstable that they have no meaning, "
        "or the duration is too long for them");
}

void StepTrace::take(const MoreauJean& integrator, const State& x, double duration, const State& end) {
  const System& system = integrator.system();
  const Formulation& formulation = integrator.formulation();
  h = duration, before = x, after = end;
  contacts.clear(), places.clear(), mu_of.clear();
  rows = formulation.size(), first_friction = rows;
  if (rows == 0) return;
  first_friction -= static_cast<Index>(system.scene().frictions.size());
  problem = formulation.problem(), z = formulation.solution().z;
  for (std::size_t k = 0; k < integrator.closed().size(); ++k) {
    contacts.push_back(integrator.closed()[k].contact);
    places.push_back({formulation.normal_row(k), formulation.tangent_row(k), false});
  }
  for (Place& place : places) place.inelastic = formulation.step_problem().dropped_restitution();
  for (const Friction& f : problem.friction)
    for (std::size_t k = 0; k < places.size(); ++k)
      if (places[k].tangent == f.first) mu_of.emplace_back(contacts[k], f.mu != system.law(contacts[k]).mu);
}

StepLinearization::StepLinearization(const System& system, const MoreauJeanOptions& options)
    : system_(system),
      options_(options),
      terms_(system),
      basic_(system),
      projection_(system),
      slopes_(static_cast<std::size_t>(system.joint_rows())),
      none_(Eigen::VectorXd::Zero(system.joint_rows())),
      unused_joints_(system.joint_rows()) {
  refuse_impact_laws(system.scene());
  if (options.sleep.after > 0)
    throw std::invalid_argument("derivatives of a run: option sleep_after = " + detail::text_of(options.sleep.after) +
                                ": must be 0, as bodies that sleep have none");
  if (options.joints != Joints::symmetric)
    throw std::invalid_argument("derivatives of a run: option joints: must be symmetric");
  if (options.form != Form::reduced)
    throw std::invalid_argument("derivatives of a run: option form = full: must be reduced");
  for (const JointFriction& f : system.scene().frictions)
    if (f.loaded())
      throw std::invalid_argument("derivatives of a step: the friction '" + f.name + "' depends on its joint's load");
  if (!system.scene().collisions.empty())
    throw std::invalid_argument("derivatives of a step: collisions that are searched have none here");
  for (auto* x : {&v_new_, &change_, &fixed_, &by_z_, &q_a_, &force_}) x->setZero(system.dof());
}

Eigen::Index StepLinearization::size() const {
  return system_.dof() + system_.joint_rows() + 2 * step_->rows + std::ssize(step_->mu_of);
}

void StepLinearization::extend(const StepTrace& given) {
  step_ = &given;
  const auto begins = [&](std::size_t k) {
    return given.places[k].normal >= 0 && given.places[k].tangent < 0 && begun_[at(given.contacts[k])] != 0 &&
           !system_.law(given.contacts[k]).frictional();
  };
  Index more = 0;
  for (std::size_t k = 0; k < given.places.size() && !begun_.empty(); ++k) more += begins(k);
  if (more == 0) return;
  extended_ = given;
  step_ = &extended_;
  for (std::size_t k = 0; k < given.places.size(); ++k) {
    if (!begins(k)) continue;
    extended_.places[k].tangent = extended_.first_friction++;
    extended_.problem.friction.push_back({given.places[k].normal, extended_.places[k].tangent, 1, 0});
    extended_.mu_of.emplace_back(given.contacts[k], false);
  }
  extended_.rows += more;
  const auto widened = [&](const Vector& x, double between) {
    Eigen::VectorXd wide = Eigen::VectorXd::Constant(extended_.rows, between);
    wide.head(given.first_friction) = x.head(given.first_friction);
    wide.tail(given.rows - given.first_friction) = x.tail(given.rows - given.first_friction);
    return wide;
  };
  extended_.z = widened(given.z, 0);
  extended_.problem.b = widened(given.problem.b, 0);
  extended_.problem.lo = widened(given.problem.lo, -kInf), extended_.problem.hi = widened(given.problem.hi, kInf);
}

void StepLinearization::form_extended(const StepTrace& given) {
  if (step_ == &given) return;
  const Index rows = extended_.rows;
  Eigen::MatrixXd A(rows, rows);
  by_z_.resize(system_.dof());
  for (Index j = 0; j < rows; ++j) {
    basic_.solve_row(rows_[at(j)], by_z_.data());
    for (Index i = 0; i < rows; ++i) A(i, j) = apply(rows_[at(i)], by_z_.data());
  }
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const Index i = places_[k].tangent;
    if (i < given.first_friction || i >= extended_.first_friction) continue;
    const ContactLaw& law = system_.law(given.contacts[k]);
    double slip = apply(rows_[at(i)], v_new_.data()) - law.belt;
    if (places_[k].strikes) slip += law.e_t * (apply(rows_[at(i)], given.before.v.data()) - law.belt);
    if (!(std::abs(slip) > kStickSpeed * law.unit)) {
      slip = 0;
      if (given.z[places_[k].normal] > 0) degenerate_.push_back(given.contacts[k]);
    }
    extended_.problem.b[i] = slip - A.row(i).dot(extended_.z);
  }
  extended_.problem.A = DenseMatrix(A);
}

void StepLinearization::set_up(const StepTrace& given) {
  degenerate_.clear(), spent_.clear(), consistent_ = true, sharing_ = Sharing::unique;
  extend(given);
  const StepTrace& step = *step_;
  const State& x = step.before;
  const double a = options_.theta, h = step.h;
  q_a_ = x.q + a * h * x.v;
  set_poses(system_, x.t + a * h, q_a_, terms_.at);
  evaluate_forces(system_, x.t + a * h, x.v, terms_);
  evaluate_joint_rows(system_, terms_);
  evaluate_closed(system_, std::span<const int>(step.contacts), terms_);
  if (!basic_.factorize(system_, terms_, h * h * a * options_.theta, h * a))
    throw std::runtime_error("derivatives of a step: not finite");
  rows_.resize(at(step.rows));
  places_ = step.places;
  bool tangents = false;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    if (places_[k].normal >= 0) rows_[at(places_[k].normal)] = terms_.closed[k].rows.normal;
    if (places_[k].tangent >= 0) rows_[at(places_[k].tangent)] = terms_.closed[k].rows.tangent, tangents = true;
  }
  for (Index i = step.first_friction; i < step.rows; ++i)
    rows_[at(i)] = system_.scene().frictions[at(i - step.first_friction)].of.row(terms_.at);

  for (std::size_t k = 0; k < places_.size(); ++k)
    places_[k].inelastic = places_[k].inelastic && apply(terms_.closed[k].rows.normal, x.v.data()) < 0;

  // v' for the z of the step; before, where it matters, v_free, which tells what strikes.
  force_ = h * terms_.f, fixed_ = x.v / a, unused_joints_ = terms_.joint_rate / a;
  joint_.setZero(system_.joint_rows());
  const auto solve = [&] {
    basic_.solve_change(terms_.G, force_.data(), fixed_.data(), unused_joints_.data(), change_.data(), joint_.data());
  };
  if (tangents) solve();
  for (std::size_t k = 0; k < places_.size() && tangents; ++k) {
    const double approach = apply(terms_.closed[k].rows.normal, x.v.data());
    places_[k].strikes =
        !places_[k].inelastic && -approach > kRestSpeed * system_.law(terms_.closed[k].contact).unit +
                                                 std::abs(apply(terms_.closed[k].rows.normal, change_.data()));
  }
  for (Index i = 0; i < step.rows; ++i) apply_transposed(rows_[at(i)], step.z[i], force_.data());
  solve();
  v_new_ = x.v + change_;
  form_extended(given);

  sensitivity_.clear();
  if (step.rows > 0) {
    solution_ = {};
    solution_.z = step.z;
    judge_.certify(step.problem, 1e-8, Claim::candidate, solution_);
    stick_.clear();
    for (const auto& [contact, is_static] : step.mu_of) stick_.push_back(kStickSpeed * system_.law(contact).unit);
    const bool shared = share_friction(step.problem, rows_, system_.dof(), solution_.w, stick_, solution_.z);
    if (shared) judge_.certify(step.problem, 1e-8, Claim::candidate, solution_);
    sensitivity_.set_up(step.problem, solution_);
    if (shared || sensitivity_.redundant()) sharing_ = Sharing::impulses;
    for (const WeaklyActive& row : sensitivity_.weakly_active()) {
      if (row.row >= step.first_friction) spent_.push_back(static_cast<int>(row.row - step.first_friction));
      for (std::size_t k = 0; k < places_.size(); ++k)
        if (places_[k].normal == row.row || places_[k].tangent == row.row) degenerate_.push_back(step.contacts[k]);
    }
    std::sort(degenerate_.begin(), degenerate_.end());
    degenerate_.erase(std::unique(degenerate_.begin(), degenerate_.end()), degenerate_.end());
  }
  linearize_rows();
  append_force_slopes(system_, terms_, {h, h * h * a * options_.theta, h * a}, x.v, change_, 0, by_pose_, by_velocity_);

  q_a_ = x.q + h * (options_.theta * v_new_ + (1 - options_.theta) * x.v);  // q*
  const double missed = projection_.set_up(x.t + h, q_a_, v_new_, step.after);
  if (!(missed <= kSameStep))
    throw std::runtime_error("derivatives of a step: at t = " + detail::text_of(x.t) +
                             " s the step is not the plain one of moreau-jean, by " + detail::text_of(missed) +
                             ": such a step has no derivative here; a smaller one may avoid it");
}

void StepLinearization::add_row(const Row& row, const RowSlope& slope, double force, const Eigen::VectorXd& u,
                                double by_rate, Index out) {
  for (const Slope& s : slope) {
    by_pose_.push_back({s.of, s.by, -force * s.value});
    by_pose_.push_back({out, s.by, u[s.of] * s.value});
  }
  if (by_rate != 0) each_entry(row, [&](Index place, double j) { by_velocity_.push_back({out, place, by_rate * j}); });
}

void StepLinearization::linearize_rows() {
  const StepTrace& step = *step_;
  const Index dof = system_.dof(), joints = system_.joint_rows();
  const double a = options_.theta;
  const auto& scene = system_.scene();
  by_pose_.clear(), by_velocity_.clear();
  for (Index i = 0; i < dof; ++i) by_velocity_.push_back({i, i, -system_.mass()[i]});
  const double of_mean = 1 / a - 1;  // of G v in r₂
  for (Index i = 0; i < joints && of_mean != 0; ++i)
    each_entry(terms_.G[at(i)], [&](Index place, double j) { by_velocity_.push_back({dof + i, place, of_mean * j}); });
  fixed_ = step.before.v / a + change_;
  for (std::size_t j = 0; j < scene.joints.size(); ++j)
    slopes_of(scene.joints[j], terms_.at, slopes_.data() + system_.first_row(j));
  for (Index i = 0; i < joints; ++i) {
    const Row& row = terms_.G[at(i)];
    add_row(row, slopes_[at(i)], joint_[i], fixed_, 0, dof + i);
  }
  std::array<RowSlope, 2> both;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const StepTrace::Place& place = places_[k];
    if (place.normal < 0) continue;
    slopes_of(scene.contacts[static_cast<std::size_t>(step.contacts[k])], terms_.at, both);
    const ContactRows& rows = terms_.closed[k].rows;
    const ContactLaw& law = system_.law(step.contacts[k]);
    const auto add = [&](const Row& row, const RowSlope& slope, Index z_row, double e) {
      fixed_ = v_new_ + e * step.before.v;
      add_row(row, slope, step.z[z_row], fixed_, e, dof + joints + z_row);
    };
    add(rows.normal, both[0], place.normal, place.inelastic ? 0 : law.e);
    if (place.tangent >= 0) add(rows.tangent, both[1], place.tangent, place.strikes ? law.e_t : 0);
  }
  for (Index i = step.first_friction; i < step.rows; ++i) {
    const Row& row = rows_[at(i)];
    slope_of(scene.frictions[at(i - step.first_friction)].of, terms_.at, both[0]);
    add_row(row, both[0], step.z[i], v_new_, 0, dof + joints + i);
  }
}

void StepLinearization::solve_columns(Index count, const double* f, const double* c, DirectionBlock& x) {
  const Index dof = system_.dof(), joints = system_.joint_rows();
  x.resize(dof, count);
  if (joints == 0 && system_.scene().springs.empty()) {  // M alone
    for (Index i = 0; i < dof; ++i)
      for (Index j = 0; j < count; ++j) x(i, j) = system_.inverse_mass()[i] * f[i * count + j];
    return;
  }
  if (count == 1) return basic_.solve(f, c != nullptr ? c : none_.data(), x.data(), unused_joints_.data());
  by_z_.resize(dof + joints);
  for (Index j = 0; j < count; ++j) {
    for (Index i = 0; i < dof; ++i) by_z_[i] = f[i * count + j];
    for (Index i = 0; i < joints; ++i) by_z_[dof + i] = c != nullptr ? c[i * count + j] : 0;
    basic_.solve(by_z_.data(), by_z_.data() + dof, fixed_.data(), unused_joints_.data());
    for (Index i = 0; i < dof; ++i) x(i, j) = fixed_[i];
  }
}

void StepLinearization::push(const std::vector<StepPart>& parameters, DirectionBlock& q, DirectionBlock& v,
                             std::vector<ImpulseChange>* impulses) {
  const StepTrace& step = *step_;
  const Index dof = system_.dof(), joints = system_.joint_rows(), count = q.cols();
  const double h = step.h, theta = options_.theta;
  rho_.setZero(size(), count);
  q_at_ = q + theta * h * v;
  orthant::apply(by_pose_, q_at_.data(), rho_.data(), count);
  orthant::apply(by_velocity_, v.data(), rho_.data(), count);
  for (Index j = 0; j < count; ++j)
    for (const auto& [place, value] : parameters[at(j)].step) rho_(place, j) += value;

  for (Index i = 0; i < (dof + joints) * count; ++i) rho_.data()[i] = -rho_.data()[i];
  solve_columns(count, rho_.data(), rho_.data() + dof * count, solved_);
  push_contacts(count, impulses);
  const double one = h * theta, other = h * (1 - theta);
  for (Index i = 0; i < dof * count; ++i) q.data()[i] += one * solved_.data()[i] + other * v.data()[i];
  v.swap(solved_);
  projection_.push({&parameters, &StepPart::projection}, q, v);
}

// ż, and what it adds to solved_.
void StepLinearization::push_contacts(Index count, std::vector<ImpulseChange>* impulses) {
  const StepTrace& step = *step_;
  const Index dof = system_.dof(), joints = system_.joint_rows(), rows = step.rows;
  for (Index j = 0; j < count && impulses != nullptr; ++j) (*impulses)[at(j)].clear(system_);
  if (rows == 0) return;
  double* const w = rho_.data() + (dof + joints) * count;
  for (Index i = 0; i < rows; ++i) add_rate(rows_[at(i)], 1, solved_.data(), count, w + i * count);
  z_.resize(rows, count);
  const double* const hi = step.first_friction < rows ? w + rows * count : nullptr;
  consistent_ = sensitivity_.tangent(w, hi, w + 2 * rows * count, count, z_.data()) && consistent_;
  add_response(count);
  for (Index j = 0; j < count && impulses != nullptr; ++j) {
    ImpulseChange& change = (*impulses)[at(j)];
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (places_[k].normal >= 0) change.normal[step.contacts[k]] = z_(places_[k].normal, j);
      if (places_[k].tangent >= 0) change.tangent[step.contacts[k]] = z_(places_[k].tangent, j);
    }
    for (Index i = step.first_friction; i < rows; ++i) change.friction[i - step.first_friction] = z_(i, j);
  }
}

// solved_ += B Jᵀ z_: row by row where fewer of them change than there are columns.
void StepLinearization::add_response(Index count) {
  const Index dof = system_.dof(), rows = step_->rows;
  changed_.clear();
  for (Index i = 0; i < rows; ++i)
    if (!z_.row(i).isZero(0)) changed_.push_back(i);  // others are open, or at a bound that stays
  if (system_.joint_rows() > 0 && std::ssize(changed_) <= count) {
    for (const Index i : changed_) {
      basic_.solve_row(rows_[at(i)], by_z_.data());
      for (Index k = 0; k < dof; ++k) add_scaled(count, by_z_[k], z_.data() + i * count, solved_.data() + k * count);
    }
    return;
  }
  forces_.setZero(dof, count);
  for (const Index i : changed_) add_impulse(rows_[at(i)], 1, z_.data() + i * count, count, forces_.data());
  solve_columns(count, forces_.data(), nullptr, by_force_);
  solved_ += by_force_;
}

void StepLinearization::pull(double* q, double* v, const ImpulseChange* impulses) {
  projection_.pull(q, v, by_projection_);
  const StepTrace& step = *step_;
  const Index dof = system_.dof(), joints = system_.joint_rows(), rows = step.rows;
  const double h = step.h;
  Eigen::Map<Eigen::VectorXd> of_q(q, dof), of_v(v, dof);
  by_step_.setZero(size());
  of_v += h * options_.theta * of_q;
  if (rows > 0) {
    by_z_.resize(dof + joints);
    basic_.solve(of_v.data(), none_.data(), by_z_.data(), unused_joints_.data());
    Vector of_z = Eigen::VectorXd::Zero(rows);
    for (Index i = 0; i < rows; ++i) of_z[i] = apply(rows_[at(i)], by_z_.data());
    for (std::size_t k = 0; k < places_.size() && impulses != nullptr; ++k) {
      if (places_[k].normal >= 0) of_z[places_[k].normal] += impulses->normal[step.contacts[k]];
      if (places_[k].tangent >= 0) of_z[places_[k].tangent] += impulses->tangent[step.contacts[k]];
    }
    if (impulses != nullptr) of_z.tail(rows - step.first_friction) += impulses->friction;
    double* const by_w = by_step_.data() + dof + joints;
    consistent_ = sensitivity_.adjoint(of_z, by_w, by_w + rows, by_w + 2 * rows) && consistent_;
    for (Index i = 0; i < rows; ++i) apply_transposed(rows_[at(i)], by_w[i], of_v.data());
  }
  basic_.solve(of_v.data(), none_.data(), by_step_.data(), by_step_.data() + dof);
  by_step_.head(dof) *= -1;

  of_v = h * (1 - options_.theta) * of_q;
  q_a_.setZero();
  apply_transposed(by_pose_, by_step_.data(), q_a_.data());
  apply_transposed(by_velocity_, by_step_.data(), v);
  of_q += q_a_;
  of_v += options_.theta * h * q_a_;
}

}  // namespace orthant
