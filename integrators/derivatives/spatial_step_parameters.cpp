// The parts of parameters in a linearized step in space.
#include <orthant/integrators/derivatives/spatial_step_linearization.h>

#include <algorithm>

namespace orthant {

void SpatialStepLinearization::part_of(const ParameterChangeOf<Spatial>& parameter, StepPart& part) {
  part.step.clear(), part.projection.clear();
  if (!parameter.of_scene()) return;
  projection_.part_of(parameter, part.projection);
  for (Index i = 0; i < parameter.mass.size(); ++i)
    if (parameter.mass[i] != 0) part.step.emplace_back(i, parameter.mass[i] * change_[i]);
  for (const auto& [body, tensor] : parameter.inertia) {
    const Vector3d moment =
        tensor * rotation<Spatial>(change_, body) - turns_[static_cast<std::size_t>(body)].impulse_of(tensor);
    for (Index i = 0; i < 3; ++i) part.step.emplace_back(Spatial::kVelocities * Index{body} + 3 + i, moment[i]);
  }
  append_force_parts(parameter, system_, terms_, share_, step_.before.v, w_, part.step);
  law_parts(parameter, part.step);
  contact_parts(parameter, part.step);
  note_jumps(parameter);
  element_parts(parameter, part.step);
}

void SpatialStepLinearization::law_parts(const ParameterChangeOf<Spatial>& parameter, SparsePart& part) const {
  const Index rates = system_.dof() + system_.joint_rows();
  const Eigen::VectorXd& v = step_.before.v;
  for (const auto& d : parameter.laws)
    for (std::size_t k = 0; k < step_.places.size(); ++k) {
      const Trace::Place& place = step_.places[k];
      if (d.contact != step_.contacts[k] || place.normal < 0) continue;
      if (d.e != 0 && !step_.places[k].inelastic)
        part.emplace_back(rates + place.normal, d.e * apply(rows_[at(place.normal)], v.data()));
      if (d.e_t != 0 && place.tangent >= 0 && place.strikes)
        for (const Index t : {place.tangent, place.tangent + 1})
          part.emplace_back(rates + t, d.e_t * (apply(rows_[at(t)], v.data()) - belt_[t]));
    }
  using Of = Trace::Coefficient;
  for (std::size_t f = 0; f < step_.friction_of.size(); ++f)
    for (const auto& d : parameter.laws) {
      const auto [contact, of] = step_.friction_of[f];
      if (d.contact != contact) continue;
      const double by = of == Of::kinetic   ? d.mu
                        : of == Of::fixed   ? d.mu_static
                        : of == Of::rolling ? d.rolling
                                            : d.spinning;
      if (by != 0) part.emplace_back(rates + 2 * step_.rows + static_cast<Index>(f), by);
    }
  for (const auto& [friction, by] : parameter.bounds)
    if (step_.first_friction < step_.rows)
      part.emplace_back(rates + step_.rows + step_.first_friction + friction, step_.h * by);
}

// Contacts with other geometry: their impulses' forces in r₁, their rates in r₃.
void SpatialStepLinearization::contact_parts(const ParameterChangeOf<Spatial>& parameter, SparsePart& part) const {
  constexpr std::size_t kEntries = 2 * Spatial::kVelocities;
  using Values = std::array<double, kEntries + SurfaceRows::kMost>;
  const Index rates = system_.dof() + system_.joint_rows();
  const Eigen::VectorXd& v = step_.before.v;
  for (std::size_t k = 0; k < step_.places.size(); ++k) {
    const int contact = step_.contacts[k];
    if (step_.places[k].normal < 0 || !std::ranges::binary_search(parameter.contacts, contact)) continue;
    const Vector3d axis = tangent_axis(system_, contact, terms_.at);
    const auto d = parameter.derivative<kEntries + SurfaceRows::kMost>([&](const System& s, Values& x) {
      const SurfaceRows there = surface_rows(s, contact, terms_.at, &axis);
      each_row(k, [&](Index row, std::size_t i) {
        const auto entries = entries_of(there.rows[i]);
        for (std::size_t e = 0; e < kEntries; ++e) x[e] += step_.z[row] * entries[e];
        x[kEntries + i] =
            apply(there.rows[i], w_.data()) + e_[row] * apply(there.rows[i], v.data()) - (1 + e_[row]) * there.belt[i];
      });
    });
    for (std::size_t e = 0; e < kEntries; ++e)
      if (const Index place = place_of_entry(surfaces_[k].rows[0], e); place >= 0) part.emplace_back(place, -d[e]);
    each_row(k, [&](Index row, std::size_t i) { part.emplace_back(rates + row, d[kEntries + i]); });
  }
}

void SpatialStepLinearization::note_jumps(const ParameterChangeOf<Spatial>& parameter) {
  for (std::size_t k = 0; k < step_.places.size(); ++k) {
    const int contact = step_.contacts[k];
    if (!std::ranges::binary_search(parameter.contacts, contact) || !jumps(k)) continue;
    const Vector3d there = spatial::direction_of(surface_rows(parameter.other(), contact, terms_.at).rows[0]);
    if ((there - spatial::direction_of(surfaces_[k].rows[0])).norm() > kTurn * parameter.step)
      jumping_.push_back(contact);
  }
}

// Joints and dry friction that have changed.
void SpatialStepLinearization::element_parts(const ParameterChangeOf<Spatial>& parameter, SparsePart& part) const {
  constexpr std::size_t kEntries = 2 * Spatial::kVelocities;
  using Values = std::array<double, kEntries + 1>;
  const Index dof = system_.dof();
  const double a = options_.theta;
  const auto push = [&](const Row& row, const Values& d, double by) {
    for (std::size_t k = 0; k < kEntries; ++k)
      if (const Index place = place_of_entry(row, k); place >= 0) part.emplace_back(place, by * d[k]);
  };
  std::vector<Row> rows;
  std::vector<double> rate;
  const Eigen::VectorXd mean = step_.before.v / a + change_;
  for (const int joint : parameter.joints) {
    const auto j = static_cast<std::size_t>(joint);
    const int first = system_.first_row(j), count = row_count(system_.scene().joints[j]);
    rows.resize(static_cast<std::size_t>(count)), rate.assign(rows.size(), 0.0);
    for (int i = 0; i < count; ++i) {
      const auto one = static_cast<std::size_t>(i);
      const auto d = parameter.derivative<kEntries + 1>([&](const System& s, Values& x) {
        std::visit(
            [&](const auto& other) {
              other.rows(terms_.at, rows.data());
              if constexpr (requires(double* r) { other.rate(terms_.at, r); }) other.rate(terms_.at, rate.data());
            },
            s.scene().joints[j]);
        const auto entries = entries_of(rows[one]);
        std::copy(entries.begin(), entries.end(), x.begin());
        x[kEntries] = apply(rows[one], mean.data()) - rate[one] / a;
      });
      push(terms_.G[at(first + i)], d, -joint_[first + i]);
      part.emplace_back(dof + first + i, d[kEntries]);
    }
  }
  for (const int friction : parameter.frictions) {
    if (step_.first_friction == step_.rows) break;
    const auto i = static_cast<std::size_t>(friction);
    const Index row = step_.first_friction + friction;
    const auto d = parameter.derivative<kEntries + 1>([&](const System& s, Values& x) {
      const Row there = s.scene().frictions[i].of.row(terms_.at);
      const auto entries = entries_of(there);
      std::copy(entries.begin(), entries.end(), x.begin());
      x[kEntries] = apply(there, w_.data());
    });
    push(rows_[at(row)], d, -step_.z[row]);
    part.emplace_back(dof + system_.joint_rows() + row, d[kEntries]);
  }
}

}  // namespace orthant
