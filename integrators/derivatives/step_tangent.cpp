#include <orthant/integrators/derivatives/step_tangent.h>

#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kSameStep = 1e-8;   // of x⁺: rounding, and what the projections leave
constexpr double kStateStep = 3e-6;  // [m, rad], of velocities over 1 m/s + the largest

/// Derivative of f, which fills a vector, at 0 along s by central differences of fourth order: f(s, r), s = ±1, ±2.
template <class F> void differentiate(double step, F&& f, Eigen::VectorXd& r, Eigen::VectorXd& derivative) {
  f(-2, r), derivative = r;
  f(-1, r), derivative -= 8 * r;
  f(1, r), derivative += 8 * r;
  f(2, r), derivative -= r;
  derivative /= 12 * step;
}

/// The change along one column: of the state by (dq, dv), then of the parameter, f(system, q, v, r).
template <class F> void differentiate(const System& system, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                      const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, double reach,
                                      const NearbySystems& parameter, F&& f, Eigen::VectorXd& r,
                                      Eigen::VectorXd& derivative) {
  Eigen::VectorXd part;
  if (reach > 0) {
    const double step = kStateStep / reach;
    differentiate(
        step, [&](int k, Eigen::VectorXd& to) { f(system, q + k * step * dq, v + k * step * dv, to); }, r, derivative);
  } else {
    f(system, q, v, derivative);
    derivative.setZero();
  }
  if (parameter.at[0] == nullptr) return;
  const auto nearby = [&](int k) -> const System& {
    return *parameter.at[static_cast<std::size_t>(k < 0 ? k + 2 : k + 1)];
  };
  differentiate(
      parameter.step, [&](int k, Eigen::VectorXd& to) { f(nearby(k), q, v, to); }, r, part);
  derivative += part;
}

double largest_part(const Eigen::VectorXd& x) { return x.size() > 0 ? x.lpNorm<Eigen::Infinity>() : 0.0; }

}  // namespace

struct StepTangent::Step {
  double t, h;
  std::vector<int> contacts;  // closed
  struct Place {
    Index normal, tangent;
    bool strikes;
  };
  std::vector<Place> places;  // of them
  Index rows = 0, first_friction = 0;
  std::vector<std::pair<int, bool>> mu_of;  // of each friction of the problem: its contact, whether μ is the static one
  Eigen::VectorXd v, z, joint;              // v', z, Λ_G
};

StepTangent::StepTangent(const System& system, const MoreauJeanOptions& options)
    : system_(system),
      options_(options),
      terms_(system),
      at_(system),
      projected_(system),
      after_(system),
      basic_(system),
      projection_(system) {
  if (options.joints != Joints::symmetric || options.form != Form::reduced)
    throw std::invalid_argument("derivatives of a step: joints and form must be symmetric and reduced");
  for (const JointFriction& f : system.scene().frictions)
    if (f.loaded())
      throw std::invalid_argument("derivatives of a step: the friction '" + f.name + "' depends on its joint's load");
  if (!system.scene().collisions.empty())
    throw std::invalid_argument("derivatives of a step: collisions that are searched have none here");
}

void StepTangent::residual(const System& system, const Step& step, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                           Eigen::VectorXd& r) {
  const double a = options_.theta, h = step.h;
  const Index dof = system.dof(), joints = system.joint_rows();
  const auto mus = static_cast<Index>(step.mu_of.size());
  set_poses(system, step.t + a * h, q + a * h * v, terms_.at);
  evaluate_forces(system, step.t + a * h, v, terms_);
  evaluate_joint_rows(system, terms_);
  evaluate_closed(system, std::span<const int>(step.contacts), terms_);
  const Eigen::VectorXd change = step.v - v;
  r.setZero(dof + joints + 2 * step.rows + mus);
  Eigen::VectorXd force = h * terms_.f;
  for (std::size_t i = 0; i < terms_.springs.size(); ++i) {
    const Row& row = terms_.springs[i].row;
    const double weight =
        std::visit([&](const auto& s) { return h * h * a * options_.theta * s.stiffness + h * a * s.damping; },
                   system.scene().springs[i]);
    apply_transposed(row, -weight * apply(row, change.data()), force.data());
  }
  for (Index i = 0; i < joints; ++i) {
    const Row& row = terms_.G[at(i)];
    apply_transposed(row, step.joint[i], force.data());
    r[dof + i] = apply(row, v.data()) / a + apply(row, change.data()) - terms_.joint_rate[i] / a;
  }
  double* const rates = r.data() + dof + joints;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const Step::Place& place = step.places[k];
    if (place.normal < 0) continue;
    const ContactRows& rows = terms_.closed[k].rows;
    const ContactLaw& law = system.law(step.contacts[k]);
    apply_transposed(rows.normal, step.z[place.normal], force.data());
    rates[place.normal] = apply(rows.normal, step.v.data()) + law.e * apply(rows.normal, v.data());
    if (place.tangent < 0) continue;
    apply_transposed(rows.tangent, step.z[place.tangent], force.data());
    rates[place.tangent] = apply(rows.tangent, step.v.data()) - law.belt;
    if (place.strikes) rates[place.tangent] += law.e_t * (apply(rows.tangent, v.data()) - law.belt);
  }
  const auto& frictions = system.scene().frictions;
  for (Index i = step.first_friction; i < step.rows; ++i) {
    const JointFriction& friction = frictions[at(i - step.first_friction)];
    const Row row = friction.of.row(terms_.at);
    apply_transposed(row, step.z[i], force.data());
    rates[i] = apply(row, step.v.data());
    rates[step.rows + i] = h * friction.bound_at(0);
  }
  for (Index f = 0; f < mus; ++f) {
    const auto [contact, is_static] = step.mu_of[at(f)];
    rates[2 * step.rows + f] = is_static ? system.law(contact).mu_static : system.law(contact).mu;
  }
  r.head(dof) = system.mass().cwiseProduct(change) - force;
}

void StepTangent::pushes(const System& system, double t, const Eigen::VectorXd& q, Eigen::VectorXd& r) {
  const Index dof = system.dof();
  set_poses(system, t, q, terms_.at);
  evaluate_joint_rows(system, terms_);
  r.setZero(2 * dof);
  for (Index i = 0; i < system.joint_rows(); ++i) {
    apply_transposed(terms_.G[at(i)], lambda_[i], r.data());
    apply_transposed(terms_.G[at(i)], nu_[i], r.data() + dof);
  }
  r.head(dof) = r.head(dof).cwiseProduct(system.inverse_mass()).eval();
  r.tail(dof) = r.tail(dof).cwiseProduct(system.inverse_mass()).eval();
}

void StepTangent::constraints(const System& system, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                              Eigen::VectorXd& r) {
  const Index joints = system.joint_rows();
  set_poses(system, t, q, terms_.at);
  evaluate_joints(system, terms_);
  r.resize(2 * joints);
  r.head(joints) = terms_.phi;
  for (Index i = 0; i < joints; ++i) r[joints + i] = -terms_.missing_rate(i, v);
}

// λ and ν of (3); missed_: what of q⁺ and v⁺ they leave.
void StepTangent::set_up_projection(double t, const Eigen::VectorXd& q_before, const Eigen::VectorXd& v_before,
                                    const State& after) {
  const Index dof = system_.dof(), joints = system_.joint_rows();
  missed_ = 0;
  lambda_.setZero(joints), nu_.setZero(joints);
  const Eigen::VectorXd moved = after.q - q_before, turned = after.v - v_before;
  Eigen::VectorXd by_q = Eigen::VectorXd::Zero(dof), by_v = by_q;
  if (joints > 0) {
    set_poses(system_, t, q_before, projected_.at);
    evaluate_joint_rows(system_, projected_);
    if (!projection_.factorize(system_, projected_)) throw std::runtime_error("derivatives of a step: not finite");
    Eigen::VectorXd rate(joints);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(dof);
    for (Index i = 0; i < joints; ++i) rate[i] = apply(projected_.G[at(i)], moved.data());
    projection_.solve(none.data(), rate.data(), by_q.data(), lambda_.data());
    for (Index i = 0; i < joints; ++i) rate[i] = apply(projected_.G[at(i)], turned.data());
    projection_.solve(none.data(), rate.data(), by_v.data(), nu_.data());
  }
  missed_ = std::max(largest_part(moved - by_q) / (1 + largest_part(after.q)),
                     largest_part(turned - by_v) / (1 + largest_part(after.v)));
}

void StepTangent::project(double t, const Eigen::VectorXd& q_before, const Eigen::VectorXd& v_before,
                          const State& after, const std::vector<NearbySystems>& parameters, Eigen::MatrixXd& dq,
                          Eigen::MatrixXd& dv) {
  const Index dof = system_.dof(), joints = system_.joint_rows();
  set_up_projection(t, q_before, v_before, after);
  if (joints == 0) return;
  set_poses(system_, t, after.q, after_.at);
  evaluate_joint_rows(system_, after_);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(dof);
  const NearbySystems no_parameter;
  Eigen::VectorXd r, derivative, off(joints);
  const auto correct = [&](Eigen::VectorXd& x, const Eigen::VectorXd& wanted) {  // G⁺ x = wanted
    for (int pass = 0; pass < 4; ++pass) {
      for (Index i = 0; i < joints; ++i) off[i] = wanted[i] - apply(after_.G[at(i)], x.data());
      projection_.add_rates(off.data(), x.data());
    }
  };
  for (Index j = 0; j < dq.cols(); ++j) {
    const NearbySystems& parameter = parameters[at(j)];
    Eigen::VectorXd q = dq.col(j), v = dv.col(j);
    differentiate(
        system_, q_before, v_before, q, none, largest_part(q), parameter,
        [&](const System& system, const Eigen::VectorXd& at_q, const Eigen::VectorXd&, Eigen::VectorXd& to) {
          pushes(system, t, at_q, to);
        },
        r, derivative);
    q += derivative.head(dof), v += derivative.tail(dof);
    const auto constrain = [&](const System& system, const Eigen::VectorXd& at_q, const Eigen::VectorXd&,
                               Eigen::VectorXd& to) { constraints(system, t, at_q, after.v, to); };
    differentiate(system_, after.q, after.v, none, none, 0, parameter, constrain, r, derivative);
    correct(q, -derivative.head(joints));
    differentiate(system_, after.q, after.v, q, none, largest_part(q), parameter, constrain, r, derivative);
    correct(v, -derivative.tail(joints));
    dq.col(j) = q, dv.col(j) = v;
  }
}

void StepTangent::begin(const State& closed, const std::vector<NearbySystems>& parameters, Eigen::MatrixXd& dq,
                        Eigen::MatrixXd& dv) {
  const State given = system_.initial_state();
  for (Index j = 0; j < dq.cols(); ++j) {
    const NearbySystems& parameter = parameters[at(j)];
    if (parameter.at[0] == nullptr) continue;
    const auto state_at = [&](int k) {
      return parameter.at[static_cast<std::size_t>(k < 0 ? k + 2 : k + 1)]->initial_state();
    };
    const State low2 = state_at(-2), low = state_at(-1), high = state_at(1), high2 = state_at(2);
    dq.col(j) += (low2.q - 8 * low.q + 8 * high.q - high2.q) / (12 * parameter.step);
    dv.col(j) += (low2.v - 8 * low.v + 8 * high.v - high2.v) / (12 * parameter.step);
  }
  project(closed.t, given.q, given.v, closed, parameters, dq, dv);
  if (!(missed_ <= kSameStep))
    throw std::invalid_argument("derivatives of a run: the start breaks the joints, by " + detail::text_of(missed_) +
                                " more than one projection closes: must keep them");
}

void StepTangent::advance(const MoreauJean& integrator, const State& x, double h, const State& after,
                          const std::vector<NearbySystems>& parameters, Eigen::MatrixXd& dq, Eigen::MatrixXd& dv) {
  const Index dof = system_.dof(), joints = system_.joint_rows();
  const double a = options_.theta;
  const Formulation& formulation = integrator.formulation();
  degenerate_.clear(), consistent_ = true;

  Step step;
  step.t = x.t, step.h = h;
  const bool solved = formulation.size() > 0;
  if (solved) {
    step.rows = formulation.size(),
    step.first_friction = step.rows - static_cast<Index>(system_.scene().frictions.size());
    step.z = formulation.solution().z;
    for (std::size_t k = 0; k < integrator.closed().size(); ++k) {
      step.contacts.push_back(integrator.closed()[k].contact);
      step.places.push_back({formulation.normal_row(k), formulation.tangent_row(k), false});
    }
    for (const Friction& f : formulation.problem().friction)
      for (std::size_t k = 0; k < step.places.size(); ++k)
        if (step.places[k].tangent == f.first)
          step.mu_of.emplace_back(step.contacts[k], f.mu != system_.law(step.contacts[k]).mu);
  }

  // (1), for the z of the step.
  set_poses(system_, x.t + a * h, x.q + a * h * x.v, at_.at);
  evaluate_forces(system_, x.t + a * h, x.v, at_);
  evaluate_joint_rows(system_, at_);
  evaluate_closed(system_, std::span<const int>(step.contacts), at_);
  if (!basic_.factorize(system_, at_, h * h * a * options_.theta, h * a))
    throw std::runtime_error("derivatives of a step: not finite");
  std::vector<Row> rows(at(step.rows));
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    if (step.places[k].normal >= 0) rows[at(step.places[k].normal)] = at_.closed[k].rows.normal;
    if (step.places[k].tangent >= 0) rows[at(step.places[k].tangent)] = at_.closed[k].rows.tangent;
  }
  for (Index i = step.first_friction; i < step.rows; ++i)
    rows[at(i)] = system_.scene().frictions[at(i - step.first_friction)].of.row(at_.at);
  Eigen::VectorXd force = h * at_.f, change(dof);
  const Eigen::VectorXd from = x.v / a, rate = at_.joint_rate / a;
  step.joint.setZero(joints);
  basic_.solve_change(at_.G, force.data(), from.data(), rate.data(), change.data(), step.joint.data());
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {  // v_free tells what strikes
    const double approach = apply(at_.closed[k].rows.normal, x.v.data());
    step.places[k].strikes = -approach > kRestSpeed + std::abs(apply(at_.closed[k].rows.normal, change.data()));
  }
  for (Index i = 0; i < step.rows; ++i) apply_transposed(rows[at(i)], step.z[i], force.data());
  basic_.solve_change(at_.G, force.data(), from.data(), rate.data(), change.data(), step.joint.data());
  step.v = x.v + change;

  std::optional<Sensitivity> sensitivity_of;
  if (solved) {
    Solution s;
    s.z = step.z;
    judge_.certify(formulation.problem(), 1e-8, Claim::candidate, s);
    sensitivity_of.emplace(formulation.problem(), s);
    for (const WeaklyActive& row : sensitivity_of->report().weakly_active)
      for (std::size_t k = 0; k < step.places.size(); ++k)
        if (step.places[k].normal == row.row || step.places[k].tangent == row.row)
          degenerate_.push_back(step.contacts[k]);
    std::sort(degenerate_.begin(), degenerate_.end());
    degenerate_.erase(std::unique(degenerate_.begin(), degenerate_.end()), degenerate_.end());
  }

  Eigen::VectorXd r, derivative, by_z(dof), none = Eigen::VectorXd::Zero(joints), unused(joints), fixed(dof);
  for (Index j = 0; j < dq.cols(); ++j) {
    const Eigen::VectorXd q = dq.col(j), v = dv.col(j);
    const double reach = std::max(largest_part(q + a * h * v), largest_part(v) / (1 + largest_part(x.v)));
    differentiate(
        system_, x.q, x.v, q, v, reach, parameters[at(j)],
        [&](const System& system, const Eigen::VectorXd& at_q, const Eigen::VectorXd& at_v, Eigen::VectorXd& to) {
          residual(system, step, at_q, at_v, to);
        },
        r, derivative);
    const Eigen::VectorXd f = -derivative.head(dof), c = -derivative.segment(dof, joints);
    basic_.solve(f.data(), c.data(), fixed.data(), unused.data());
    if (solved) {
      Perturbation by;
      by.b = derivative.segment(dof + joints, step.rows);
      for (Index i = 0; i < step.rows; ++i) by.b[i] += apply(rows[at(i)], fixed.data());
      by.hi = derivative.segment(dof + joints + step.rows, step.rows);
      by.lo = -by.hi;
      by.mu = derivative.tail(static_cast<Index>(step.mu_of.size()));
      const SolutionTangent t = sensitivity_of->jvp(by);
      consistent_ = consistent_ && t.consistent;
      force.setZero(dof);
      for (Index i = 0; i < step.rows; ++i) apply_transposed(rows[at(i)], t.z[i], force.data());
      basic_.solve(force.data(), none.data(), by_z.data(), unused.data());
      fixed += by_z;
    }
    dq.col(j) = q + h * (options_.theta * fixed + (1 - options_.theta) * v);
    dv.col(j) = fixed;
  }
  const Eigen::VectorXd q_before = x.q + h * (options_.theta * step.v + (1 - options_.theta) * x.v);
  project(x.t + h, q_before, step.v, after, parameters, dq, dv);
  if (!(missed_ <= kSameStep))
    throw std::runtime_error("derivatives of a step: at t = " + detail::text_of(x.t) +
                             " s the step is not the plain one of moreau-jean, by " + detail::text_of(missed_));
}

}  // namespace orthant
