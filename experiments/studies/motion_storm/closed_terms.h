// experiments/studies/motion_storm/closed_terms.h — rows of joints and closed contacts at a state, as dense vectors.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

#include <vector>

namespace orthant::motion_storm {

/// Contacts count as closed up to `gap` [m]. Listed ones only.
template <class Space> TermsOf<Space> closed_terms(const SystemOf<Space>& system, const State& x, double gap) {
  TermsOf<Space> terms(system);
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_rows(system, terms), evaluate_gaps(system, terms), evaluate_closed(system, gap, terms);
  return terms;
}

template <class Space> Eigen::VectorXd dense(const RowOf<Space>& row, Eigen::Index dof) {
  constexpr int n = Space::kVelocities;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(dof);
  for (const auto& [body, entries] : {std::pair{row.a, row.ja}, std::pair{row.b, row.jb}})
    for (int k = 0; body >= 0 && k < n; ++k) all[n * body + k] += entries[static_cast<std::size_t>(k)];
  return all;
}

/// Of a closed contact: rows of slip [m/s], and the slip against b's surface.
inline std::vector<Eigen::VectorXd> dense_tangents(const ContactRows& rows, Eigen::Index dof) {
  return {dense(rows.tangent, dof)};
}
inline std::vector<Eigen::VectorXd> dense_tangents(const ContactRowsOf<Spatial>& rows, Eigen::Index dof) {
  return {dense(rows.tangents[0], dof), dense(rows.tangents[1], dof)};
}
template <class Space>
Eigen::VectorXd slip_of(const ContactLaw& law, const ContactRowsOf<Space>& rows, const Eigen::VectorXd& v) {
  const auto slip = slip_rate(rows, v.data()) - belt_of(law, rows);
  Eigen::VectorXd all(Space::kTangents);
  for (Eigen::Index i = 0; i < Space::kTangents; ++i) all[i] = tangent_part(slip, static_cast<std::size_t>(i));
  return all;
}

}  // namespace orthant::motion_storm
