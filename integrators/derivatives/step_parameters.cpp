// The parts of parameters in a linearized step.
#include <orthant/integrators/derivatives/step_linearization.h>

#include <algorithm>

namespace orthant {

void StepLinearization::part_of(const ParameterChange& parameter, StepPart& part) {
  part.step.clear(), part.projection.clear();
  if (!parameter.of_scene()) return;
  projection_.part_of(parameter, part.projection);
  const double h = step_->h, a = options_.theta;
  if (parameter.mass.size() > 0)
    for (Index i = 0; i < system_.dof(); ++i)
      if (parameter.mass[i] != 0) part.step.emplace_back(i, parameter.mass[i] * change_[i]);
  append_force_parts(parameter, system_, terms_, {h, h * h * a * options_.theta, h * a}, step_->before.v, change_, 0,
                     part.step);
  contact_parts(parameter, part.step);
  element_parts(parameter, part.step);
}

void StepLinearization::contact_parts(const ParameterChange& parameter, SparsePart& part) const {
  const StepTrace& step = *step_;
  const Index rates = system_.dof() + system_.joint_rows();
  const Eigen::VectorXd& v = step.before.v;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const StepTrace::Place& place = places_[k];
    const ContactRows& rows = terms_.closed[k].rows;
    if (place.normal < 0) continue;
    for (const ParameterChange::Law& d : parameter.laws) {
      if (d.contact != step.contacts[k]) continue;
      if (d.e != 0 && !place.inelastic) part.emplace_back(rates + place.normal, d.e * apply(rows.normal, v.data()));
      if (place.tangent < 0) continue;
      const ContactLaw& law = system_.law(d.contact);
      double by = -d.belt;
      if (place.strikes) by += d.e_t * (apply(rows.tangent, v.data()) - law.belt) - law.e_t * d.belt;
      if (by != 0) part.emplace_back(rates + place.tangent, by);
    }
    if (std::find(parameter.contacts.begin(), parameter.contacts.end(), step.contacts[k]) == parameter.contacts.end())
      continue;
    const auto contact = static_cast<std::size_t>(step.contacts[k]);
    const ContactLaw& law = system_.law(step.contacts[k]);
    const double normal = step.z[place.normal], tangent = place.tangent >= 0 ? step.z[place.tangent] : 0;
    const double e = place.inelastic ? 0 : law.e, e_t = place.strikes ? law.e_t : 0;
    const auto d = parameter.derivative<8>([&](const System& s, std::array<double, 8>& x) {
      const ContactRows there =
          std::visit([&](const auto& c) { return c.rows(terms_.at); }, s.scene().contacts[contact]);
      const auto one = entries_of(there.normal), other = entries_of(there.tangent);
      for (std::size_t i = 0; i < 6; ++i) x[i] = normal * one[i] + tangent * other[i];
      x[6] = apply(there.normal, v_new_.data()) + e * apply(there.normal, v.data());
      x[7] = apply(there.tangent, v_new_.data()) + e_t * apply(there.tangent, v.data());
    });
    for (int i = 0; i < 6; ++i)
      if (const BodyId body = i < 3 ? rows.normal.a : rows.normal.b; body >= 0)
        part.emplace_back(kBlock * body + i % 3, -d[static_cast<std::size_t>(i)]);
    part.emplace_back(rates + place.normal, d[6]);
    if (place.tangent >= 0) part.emplace_back(rates + place.tangent, d[7]);
  }
  for (std::size_t f = 0; f < step.mu_of.size(); ++f)
    for (const ParameterChange::Law& d : parameter.laws)
      if (d.contact == step.mu_of[f].first)
        part.emplace_back(rates + 2 * step.rows + static_cast<Index>(f), step.mu_of[f].second ? d.mu_static : d.mu);
  for (const auto& [friction, by] : parameter.bounds)
    if (step.first_friction < step.rows)
      part.emplace_back(rates + step.rows + step.first_friction + friction, step.h * by);
}

// Joints and dry friction that have changed.
void StepLinearization::element_parts(const ParameterChange& parameter, SparsePart& part) const {
  const StepTrace& step = *step_;
  const Index dof = system_.dof();
  const double a = options_.theta;
  const auto push = [&](const Row& row, const double* six, double by) {
    for (int i = 0; i < 6; ++i)
      if (const BodyId body = i < 3 ? row.a : row.b; body >= 0) part.emplace_back(kBlock * body + i % 3, by * six[i]);
  };
  std::vector<Row> rows;
  std::vector<double> rate;
  Eigen::VectorXd mean;
  if (!parameter.joints.empty()) mean = step.before.v / a + change_;
  for (const int joint : parameter.joints) {
    const auto j = static_cast<std::size_t>(joint);
    const int first = system_.first_row(j), count = row_count(system_.scene().joints[j]);
    rows.resize(static_cast<std::size_t>(count)), rate.assign(rows.size(), 0.0);
    for (int i = 0; i < count; ++i) {
      const auto one = static_cast<std::size_t>(i);
      const auto d = parameter.derivative<7>([&](const System& s, std::array<double, 7>& x) {
        std::visit(
            [&](const auto& other) {
              other.rows(terms_.at, rows.data());
              if constexpr (requires(double* r) { other.rate(terms_.at, r); }) other.rate(terms_.at, rate.data());
            },
            s.scene().joints[j]);
        const auto entries = entries_of(rows[one]);
        std::copy(entries.begin(), entries.end(), x.begin());
        x[6] = apply(rows[one], mean.data()) - rate[one] / a;
      });
      push(terms_.G[at(first + i)], d.data(), -joint_[first + i]);
      part.emplace_back(dof + first + i, d[6]);
    }
  }
  for (const int friction : parameter.frictions) {
    if (step.first_friction == step.rows) break;
    const auto i = static_cast<std::size_t>(friction);
    const Index row = step.first_friction + friction;
    const auto d = parameter.derivative<7>([&](const System& s, std::array<double, 7>& x) {
      const Row there = s.scene().frictions[i].of.row(terms_.at);
      const auto entries = entries_of(there);
      std::copy(entries.begin(), entries.end(), x.begin());
      x[6] = apply(there, v_new_.data());
    });
    push(rows_[at(row)], d.data(), -step.z[row]);
    part.emplace_back(dof + system_.joint_rows() + row, d[6]);
  }
}

}  // namespace orthant
