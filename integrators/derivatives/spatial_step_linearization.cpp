#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/spatial_step_linearization.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kPlainStep = 1e-8;  // of x⁺ and of w: rounding, and what solver and projections leave

[[noreturn]] void refuse_step(double t, const std::string& why) {
  throw std::runtime_error("derivatives of a step: at t = " + detail::text_of(t) +
                           " s the step is not the plain one of moreau-jean" + why);
}

}  // namespace

void SpatialStepTrace::take(const MoreauJeanOf<Spatial>& integrator, const State& x, double duration,
                            const State& end) {
  const auto& formulation = integrator.formulation();
  h = duration, before = x, after = end;
  contacts.clear(), places.clear(), friction_of.clear(), friction.clear();
  rows = formulation.size(), first_friction = rows;
  if (rows == 0) return;
  first_friction -= std::ssize(integrator.system().scene().frictions);
  const Lcp& problem = formulation.problem();
  friction = problem.friction, lo = problem.lo, hi = problem.hi, z = formulation.solution().z;
  for (std::size_t k = 0; k < integrator.closed().size(); ++k) {
    contacts.push_back(integrator.closed()[k].contact);
    places.push_back({formulation.normal_row(k), formulation.tangent_row(k)});
  }
  for (Place& place : places) place.inelastic = formulation.step_problem().dropped_restitution();
  for (const Friction& f : friction) {
    const auto k = static_cast<std::size_t>(
        std::ranges::find_if(places, [&](const Place& p) { return p.normal == f.normal; }) - places.begin());
    const ContactLaw& law = integrator.system().law(contacts.at(k));
    Coefficient of = f.mu != law.mu ? Coefficient::fixed : Coefficient::kinetic;
    if (f.first != places[k].tangent) {
      of = f.rows == 2 ? Coefficient::rolling : Coefficient::spinning;
      (f.rows == 2 ? places[k].rolling : places[k].spinning) = f.first;
    }
    friction_of.emplace_back(contacts[k], of);
  }
}

SpatialStepLinearization::SpatialStepLinearization(const System& system, const MoreauJeanOptions& options)
    : system_(system), options_(options), terms_(system), independent_(system), saddle_(system), projection_(system) {
  refuse_impact_laws(system.scene());
  if (options.sleep.after > 0)
    throw std::invalid_argument("derivatives of a run: option sleep_after = " + detail::text_of(options.sleep.after) +
                                ": must be 0, as bodies that sleep have none");
  if (options.joints != Joints::symmetric)
    throw std::invalid_argument("derivatives of a run: option joints: must be symmetric");
  if (options.form != Form::reduced)
    throw std::invalid_argument("derivatives of a run: option form = full: must be reduced");
  if (!system.scene().collisions.empty())
    throw std::invalid_argument("derivatives of a step: collisions that are searched have none here");
  for (Index i = 0; i < system.bodies(); ++i) {
    const Vector3d J = rotation<Spatial>(system.mass(), i);
    turning_ = turning_ || J[0] != J[1] || J[1] != J[2];
  }
  for (auto* x : {&w_, &change_, &end_, &force_, &x_}) x->setZero(system.dof());
  joint_.setZero(system.joint_rows()), rate_ = joint_;
}

Eigen::Index SpatialStepLinearization::size() const {
  return system_.dof() + system_.joint_rows() + 2 * step_.rows + std::ssize(step_.friction);
}

// The rows of friction that begins come before dry friction in joints, with μ = 0.
void SpatialStepLinearization::extend(const Trace& given) {
  step_ = given;
  std::vector<std::size_t> begins;
  for (std::size_t k = 0; k < given.places.size() && !begun_.empty(); ++k)
    if (given.places[k].normal >= 0 && given.places[k].tangent < 0 && begun_[at(given.contacts[k])] != 0 &&
        !system_.law(given.contacts[k]).frictional())
      begins.push_back(k);
  if (begins.empty()) return;
  for (const std::size_t k : begins) {
    step_.places[k].tangent = step_.first_friction;
    step_.friction.push_back({.normal = given.places[k].normal, .first = step_.first_friction, .rows = 2, .mu = 0});
    step_.friction_of.emplace_back(given.contacts[k], Trace::Coefficient::kinetic);
    step_.first_friction += 2, step_.rows += 2;
  }
  const auto widened = [&](const Vector& x, double between) -> Vector {
    Eigen::VectorXd wide = Eigen::VectorXd::Constant(step_.rows, between);
    wide.head(given.first_friction) = x.head(given.first_friction);
    wide.tail(given.rows - given.first_friction) = x.tail(given.rows - given.first_friction);
    return wide;
  };
  step_.lo = widened(given.lo, -kInf), step_.hi = widened(given.hi, kInf), step_.z = widened(given.z, 0);
}

void SpatialStepLinearization::collect_rows() {
  const Index n = step_.rows;
  rows_.resize(at(n)), belt_.setZero(n), e_.setZero(n);
  surfaces_.clear();
  for (const int contact : step_.contacts) surfaces_.push_back(surface_rows(system_, contact, terms_.at));
  for (std::size_t k = 0; k < surfaces_.size(); ++k)
    each_row(
        k, [&](Index row, std::size_t i) { rows_[at(row)] = surfaces_[k].rows[i], belt_[row] = surfaces_[k].belt[i]; });
  for (Index i = step_.first_friction; i < n; ++i)
    rows_[at(i)] = system_.scene().frictions[at(i - step_.first_friction)].of.row(terms_.at);
}

// Restitution of the rows: of tangents where the contact strikes, which the step without contacts tells.
void SpatialStepLinearization::find_strikes() {
  bool any = false;
  for (std::size_t k = 0; k < step_.contacts.size(); ++k) {
    const ContactLaw& law = system_.law(step_.contacts[k]);
    Trace::Place& place = step_.places[k];
    place.inelastic = place.inelastic && apply(surfaces_[k].rows[0], step_.before.v.data()) < 0;
    if (place.normal >= 0) e_[place.normal] = place.inelastic ? 0 : law.e;
    any = any || step_.places[k].tangent >= 0;  // a parameter may change e_t = 0
  }
  if (!any) return;
  solve_step(nullptr);
  for (std::size_t k = 0; k < step_.contacts.size(); ++k) {
    const ContactLaw& law = system_.law(step_.contacts[k]);
    const Row& normal = surfaces_[k].rows[0];
    const double approach = apply(normal, step_.before.v.data());
    step_.places[k].strikes =
        !step_.places[k].inelastic && -approach > kRestSpeed * law.unit + std::abs(apply(normal, change_.data()));
    if (const Index t = step_.places[k].tangent; t >= 0 && step_.places[k].strikes) e_[t] = e_[t + 1] = law.e_t;
  }
}

void SpatialStepLinearization::solve_step(const Vector* z) {
  constexpr int kMostPasses = 30;
  constexpr double kSettles = 1e-9;  // of the velocities, in the metric of M: the next change is its square
  const Eigen::VectorXd& v = step_.before.v;
  const double a = options_.theta;
  const std::vector<Eigen::Index>& independent = independent_.find(terms_);
  const Eigen::VectorXd root = system_.mass().cwiseSqrt();
  rate_ = terms_.joint_rate / a;
  for (Index i = 0; i < rate_.size(); ++i) rate_[i] -= apply(terms_.G[at(i)], v.data()) / a;
  std::vector<Slope> added;
  Eigen::VectorXd g = Eigen::VectorXd::Zero(system_.dof());
  w_ = v;
  for (int pass = 0;; ++pass) {
    gyroscopic_impulse(system_, frames_, v, w_, g);
    force_ = share_.duration * terms_.f + g;
    added.clear();
    append_added_mass(system_, terms_, share_, added);
    find_turns();
    for (Index body = 0; body < system_.bodies(); ++body) {
      Eigen::Matrix3d by_omega, by_w;
      turns_[at(body)].of_impulse(rotation<Spatial>(system_.mass(), body), by_omega, by_w);
      rotation<Spatial>(force_, body) -= by_w * (rotation<Spatial>(w_, body) - rotation<Spatial>(v, body));
      const Index first = Spatial::kVelocities * body + 3;
      append_turn_slopes(added, first, first, -by_w);
    }
    for (Index i = 0; i < step_.rows && z != nullptr; ++i) apply_transposed(rows_[at(i)], (*z)[i], force_.data());
    saddle_.set_up(added, terms_.G, terms_.G, independent);
    saddle_.solve(force_.data(), rate_.data(), change_.data(), joint_.data());
    x_ = v + change_;
    const double off = (x_ - w_).cwiseProduct(root).lpNorm<Eigen::Infinity>();
    const double all = x_.cwiseProduct(root).lpNorm<Eigen::Infinity>();
    w_ = x_;
    if (!turning_ || off <= kSettles * all) break;
    if (pass == kMostPasses || !std::isfinite(off))
      refuse_step(step_.before.t, ": its gyroscopic impulses are not found");
  }
  find_turns();
}

// Of w_: v' and the slopes of the turns.
void SpatialStepLinearization::find_turns() {
  const Eigen::VectorXd& v = step_.before.v;
  end_ = w_;
  to_end_axes(system_, frames_, v, end_);
  turns_.clear();
  for (Index body = 0; body < system_.bodies(); ++body)
    turns_.emplace_back(frames_, rotation<Spatial>(v, body), rotation<Spatial>(w_, body),
                        rotation<Spatial>(end_, body));
}

void SpatialStepLinearization::note_degenerate(Index row) {
  for (std::size_t k = 0; k < step_.places.size(); ++k)
    each_row(k, [&](Index of, std::size_t /*i*/) {
      if (of == row) degenerate_.push_back(step_.contacts[k]);
    });
}

// problem_: the step's one, with the response of gyroscopic impulses in its matrix.
void SpatialStepLinearization::find_problem() {
  const Index n = step_.rows;
  response_.resize(system_.dof(), n);
  Eigen::MatrixXd A(n, n);
  for (Index j = 0; j < n; ++j) {
    x_.setZero();
    apply_transposed(rows_[at(j)], 1, x_.data());
    saddle_.solve(x_.data(), nullptr, force_.data());
    response_.col(j) = force_;
    for (Index i = 0; i < n; ++i) A(i, j) = apply(rows_[at(i)], force_.data());
  }
  x_ = w_;
  problem_.b.resize(n);
  for (Index i = 0; i < n; ++i)
    problem_.b[i] =
        apply(rows_[at(i)], w_.data()) + e_[i] * apply(rows_[at(i)], step_.before.v.data()) - (1 + e_[i]) * belt_[i];
  for (std::size_t k = 0; k < step_.friction.size(); ++k) {  // friction that begins, without slip
    const Friction& f = step_.friction[k];
    const ContactLaw& law = system_.law(step_.friction_of[k].first);
    if (f.mu != 0 || std::hypot(problem_.b[f.first], problem_.b[f.first + f.rows - 1]) > kStickSpeed * law.unit)
      continue;
    problem_.b.segment(f.first, f.rows).setZero();
    if (step_.z[f.normal] > 0) note_degenerate(f.normal);
  }
  const Eigen::VectorXd w = problem_.b;
  problem_.b -= A * step_.z;
  problem_.A = DenseMatrix(A);
  problem_.lo = step_.lo, problem_.hi = step_.hi, problem_.friction = step_.friction;
}

bool SpatialStepLinearization::any_slides() const {
  for (std::size_t k = 0; k < step_.friction.size(); ++k) {
    const Friction& f = step_.friction[k];
    const double slip = f.rows == 1 ? std::abs(solution_.w[f.first]) : solution_.w.segment(f.first, f.rows).norm();
    if (f.mu > 0 && step_.z[f.normal] > 0 && slip > kStickSpeed * system_.law(step_.friction_of[k].first).unit)
      return true;
  }
  return false;
}

void SpatialStepLinearization::find_pattern() {
  sensitivity_.clear();
  if (step_.rows == 0) return;
  find_problem();
  solution_ = {};
  solution_.z = step_.z;
  judge_.certify(problem_, kPlainStep, Claim::candidate, solution_);
  if (!has_answer(solution_.status)) refuse_step(step_.before.t, ": its impulses are not those of the contact laws");
  sensitivity_.set_up(problem_, solution_);
  if (sensitivity_.redundant()) sharing_ = any_slides() ? Sharing::motion : Sharing::impulses;
  for (const WeaklyActive& row : sensitivity_.weakly_active()) {
    note_degenerate(row.row);
    if (row.row >= step_.first_friction) spent_.push_back(static_cast<int>(row.row - step_.first_friction));
  }
  for (std::size_t k = 0; k < step_.places.size(); ++k)
    if (const Index row = step_.places[k].normal;
        row >= 0 && step_.z[row] > 0 && turning_length(system_, step_.contacts[k], terms_.at) == 0)
      degenerate_.push_back(step_.contacts[k]);
  std::sort(degenerate_.begin(), degenerate_.end());
  degenerate_.erase(std::unique(degenerate_.begin(), degenerate_.end()), degenerate_.end());
}

void SpatialStepLinearization::set_up(const Trace& given) {
  degenerate_.clear(), spent_.clear(), jumping_.clear(), consistent_ = true, sharing_ = Sharing::unique;
  extend(given);
  const State& x = step_.before;
  const double a = options_.theta, theta = options_.theta, h = step_.h;
  frames_ = {h, a, theta}, share_ = {h, h * h * a * theta, h * a};
  move<Spatial>(x.q, a * h * x.v, q_end_);
  set_poses(system_, x.t + a * h, q_end_, terms_.at);
  evaluate_forces(system_, x.t + a * h, x.v, terms_);
  evaluate_joint_rows(system_, terms_);
  collect_rows();
  find_strikes();
  solve_step(&step_.z);
  find_pattern();
  by_pose_.clear(), by_start_.clear();
  linearize_frames();
  linearize_rows();
  std::vector<Slope> by_velocity;
  append_force_slopes(system_, terms_, share_, x.v, w_, by_pose_, by_velocity);
  for (const Slope& s : by_velocity) by_start_.push_back({s.of, system_.dof() + s.by, s.value});

  move<Spatial>(x.q, h * (theta * end_ + (1 - theta) * x.v), q_end_);  // q*
  const double missed = projection_.set_up(x.t + h, q_end_, end_, step_.after);
  if (!(missed <= kPlainStep)) refuse_step(x.t, ", by " + detail::text_of(missed));
}

void SpatialStepLinearization::push(const std::vector<StepPart>& parameters, DirectionBlock& q, DirectionBlock& v,
                                    std::vector<ImpulseChange>* impulses) {
  const Index dof = system_.dof(), joints = system_.joint_rows(), count = q.cols(), n = step_.rows;
  start_.resize(2 * dof, count);
  start_.topRows(dof) = q, start_.bottomRows(dof) = v;
  middle_.setZero(dof, count), rho_.setZero(size(), count);
  apply(to_middle_, start_.data(), middle_.data(), count);
  apply(by_pose_, middle_.data(), rho_.data(), count);
  apply(by_start_, start_.data(), rho_.data(), count);
  for (Index j = 0; j < count; ++j)
    for (const auto& [place, value] : parameters[at(j)].step) rho_(place, j) += value;
  solved_.resize(dof, count);
  for (Index j = 0; j < count; ++j) {
    force_ = -rho_.col(j).head(dof), rate_ = -rho_.col(j).segment(dof, joints);
    saddle_.solve(force_.data(), rate_.data(), x_.data());
    solved_.col(j) = x_;
  }
  if (n > 0) {
    double* const w = rho_.data() + (dof + joints) * count;
    for (Index i = 0; i < n; ++i) add_rate(rows_[at(i)], 1, solved_.data(), count, w + i * count);
    z_.resize(n, count);
    const double* const hi = step_.first_friction < n ? w + n * count : nullptr;
    consistent_ = sensitivity_.tangent(w, hi, w + 2 * n * count, count, z_.data()) && consistent_;
    solved_ += response_ * z_;
  }
  for (Index j = 0; j < count && impulses != nullptr; ++j) {
    ImpulseChange& change = (*impulses)[at(j)];
    change.clear(system_);
    for (std::size_t k = 0; k < step_.places.size(); ++k) {
      const Trace::Place& place = step_.places[k];
      if (place.normal >= 0) change.normal[step_.contacts[k]] = z_(place.normal, j);
      if (place.tangent < 0) continue;
      change.tangent[step_.contacts[k]] = z_(place.tangent, j);
      change.across[step_.contacts[k]] = z_(place.tangent + 1, j);
    }
    for (Index i = step_.first_friction; i < n; ++i) change.friction[i - step_.first_friction] = z_(i, j);
  }
  both_.setZero(2 * dof, count);
  apply(end_by_start_, start_.data(), both_.data(), count);
  apply(end_by_w_, solved_.data(), both_.data(), count);
  q = both_.topRows(dof), v = both_.bottomRows(dof);
  projection_.push({&parameters, &StepPart::projection}, q, v);
}

void SpatialStepLinearization::pull(double* q, double* v, const ImpulseChange* impulses) {
  projection_.pull(q, v, by_projection_);
  const Index dof = system_.dof(), joints = system_.joint_rows(), n = step_.rows;
  Eigen::VectorXd end(2 * dof), start = Eigen::VectorXd::Zero(2 * dof), middle = Eigen::VectorXd::Zero(dof);
  end << Eigen::Map<const Eigen::VectorXd>(q, dof), Eigen::Map<const Eigen::VectorXd>(v, dof);
  x_.setZero();
  apply_transposed(end_by_start_, end.data(), start.data());
  apply_transposed(end_by_w_, end.data(), x_.data());
  by_step_.setZero(size());
  if (n > 0) {
    Vector of_z = response_.transpose() * x_;
    for (std::size_t k = 0; k < step_.places.size() && impulses != nullptr; ++k) {
      const Trace::Place& place = step_.places[k];
      if (place.normal >= 0) of_z[place.normal] += impulses->normal[step_.contacts[k]];
      if (place.tangent < 0) continue;
      of_z[place.tangent] += impulses->tangent[step_.contacts[k]];
      of_z[place.tangent + 1] += impulses->across[step_.contacts[k]];
    }
    if (impulses != nullptr) of_z.tail(n - step_.first_friction) += impulses->friction;
    double* const by_w = by_step_.data() + dof + joints;
    consistent_ = sensitivity_.adjoint(of_z, by_w, by_w + n, by_w + 2 * n) && consistent_;
    for (Index i = 0; i < n; ++i) apply_transposed(rows_[at(i)], by_w[i], x_.data());
  }
  saddle_.solve_adjoint(x_.data(), by_step_.data(), by_step_.data() + dof);
  by_step_.head(dof + joints) *= -1;
  apply_transposed(by_pose_, by_step_.data(), middle.data());
  apply_transposed(by_start_, by_step_.data(), start.data());
  apply_transposed(to_middle_, middle.data(), start.data());
  Eigen::Map<Eigen::VectorXd>(q, dof) = start.head(dof), Eigen::Map<Eigen::VectorXd>(v, dof) = start.tail(dof);
}

}  // namespace orthant
