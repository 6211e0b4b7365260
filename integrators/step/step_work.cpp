#include <orthant/integrators/step/step_work.h>

#include <algorithm>

namespace orthant {

template <class Space> bool has_work(const SystemOf<Space>& system) {
  return system.driven() || !system.scene().loads.empty() ||
         std::ranges::any_of(system.laws(), [](const ContactLaw& law) { return law.belt != 0 || law.surface.moves(); });
}

template <class Space> StepWorkOf<Space>::StepWorkOf(const SystemOf<Space>& system)
    : system_(system),
      terms_(system),
      basic_(system),
      to_(terms_.at),
      middle_(system.coordinates()),
      force_(system.dof()),
      mean_(system.dof()),
      lambda_(system.joint_rows()),
      rate_(system.joint_rows()),
      none_(Eigen::VectorXd::Zero(system.joint_rows())),
      has_belts_(std::ranges::any_of(system.laws(), [](const ContactLaw& law) { return law.surface.moves(); })) {}

/// terms_.at are the poses at `from`.
template <> double StepWorkOf<Planar>::of_loads(const State& from, const State& to) {
  if (system_.scene().loads.empty()) return 0;
  set_poses(system_, to.t, to.q, to_);
  double sum = 0;
  for (const Load& load : system_.scene().loads) {
    const auto place = [&](const Kinematics& k) -> Vector2d {
      return k.at(load.body).x + k.at(load.body).turn(load.point);
    };
    const auto factor = [&](double t) { return load.factor ? load.factor(t) : 1.0; };
    const double scale = load.factor ? (factor(from.t) + 4 * factor((from.t + to.t) / 2) + factor(to.t)) / 6 : 1;
    sum += scale * (load.force.dot(place(to_) - place(terms_.at)) +
                    load.torque * (to_.at(load.body).theta - terms_.at.at(load.body).theta));
  }
  return sum;
}

template <> double StepWorkOf<Spatial>::of_loads(const State& from, const State& to) {
  if (system_.scene().loads.empty()) return 0;
  const double h = to.t - from.t;
  set_middle(from, to);
  set_poses(system_, from.t + h / 2, middle_, to_);
  mean_ = (from.v + to.v) / 2;
  force_.setZero();
  for (const spatial::Load& load : system_.scene().loads) load.add(to_, from.t + h / 2, force_.data());
  return h * force_.dot(mean_);
}

template <class Space> void StepWorkOf<Space>::set_middle(const State& from, const State& to) {
  if constexpr (kPlanar<Space>)
    middle_ = (from.q + to.q) / 2;
  else
    move<Space>(from.q, between<Space>(from.q, to.q) / 2, middle_);
}

template <class Space>
double StepWorkOf<Space>::over_step(const State& from, const State& to, const std::vector<ImpulseOf<Space>>& impulses,
                                    const std::vector<double>& frictions, std::span<const Pair> pairs) {
  const double h = to.t - from.t, t = from.t + h / 2;
  set_poses(system_, from.t, from.q, terms_.at);
  double sum = of_loads(from, to);
  if constexpr (kPlanar<Space>) {
    for (std::size_t i = 0; i < impulses.size(); ++i)
      if (impulses[i].tangent != 0) sum += impulses[i].tangent * system_.laws()[i].belt;
  } else if (has_belts_) {
    if (!pairs.empty()) terms_.pairs.assign(pairs.begin(), pairs.end());
    terms_.closed.clear();
    for (std::size_t i = 0; i < impulses.size(); ++i) {
      if (impulses[i].tangent == Tangents{} || !system_.laws()[i].surface.moves()) continue;
      add_closed(system_, static_cast<int>(i), terms_);
      sum += inner(impulses[i].tangent, terms_.closed.back().rows.belt);
    }
  }
  if (!system_.driven()) return sum;

  evaluate_joint_rows(system_, terms_);  // rates at both ends: their mean is right where a drive's rate jumps, too
  rate_ = terms_.joint_rate;
  set_poses(system_, to.t, to.q, terms_.at);
  evaluate_joint_rows(system_, terms_);
  rate_ = (rate_ + terms_.joint_rate) / 2;
  set_middle(from, to), mean_ = (from.v + to.v) / 2;
  if (!pairs.empty()) terms_.pairs.assign(pairs.begin(), pairs.end());
  set_poses(system_, t, middle_, terms_.at);
  evaluate_forces(system_, t, mean_, terms_);
  evaluate_joint_rows(system_, terms_);
  add_gyroscopic(system_, mean_, terms_.f);
  force_ = h * terms_.f - system_.mass().cwiseProduct(to.v - from.v);
  terms_.closed.clear();
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    if (impulses[i].normal == 0 && impulses[i].tangent == Tangent<Space>{}) continue;
    add_closed(system_, static_cast<int>(i), terms_);
    apply_transposed(terms_.closed.back().rows.normal, impulses[i].normal, force_.data());
    for (std::size_t k = 0; k < Space::kTangents; ++k)
      apply_transposed(row_of_tangent(terms_.closed.back().rows, k), tangent_part(impulses[i].tangent, k),
                       force_.data());
  }
  for (std::size_t i = 0; i < frictions.size(); ++i)
    apply_transposed(system_.scene().frictions[i].of.row(terms_.at), frictions[i], force_.data());
  if (!basic_.factorize(system_, terms_)) return sum;
  basic_.solve(force_.data(), none_.data(), middle_.data(), lambda_.data());
  return sum + lambda_.dot(rate_);
}

template bool has_work(const SystemOf<Planar>&);
template bool has_work(const SystemOf<Spatial>&);
template <class Space>
double gain_of_crossing(const SystemOf<Space>& system, const State& from, const State& to, double work) {
  constexpr double kRounding = 1e-9;
  const double before = energy(system, from), after = energy(system, to), gain = after - before - work;
  return gain > kRounding * (std::abs(before) + std::abs(after)) ? gain : 0;
}
template double gain_of_crossing(const SystemOf<Planar>&, const State&, const State&, double);
template double gain_of_crossing(const SystemOf<Spatial>&, const State&, const State&, double);

template class StepWorkOf<Planar>;
template class StepWorkOf<Spatial>;

}  // namespace orthant
