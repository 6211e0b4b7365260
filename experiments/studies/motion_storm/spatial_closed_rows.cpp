#include "experiments/studies/motion_storm/closed_rows.h"

#include <orthant/core/mechanics/dynamics/terms.h>

namespace orthant::motion_storm {
namespace {

Eigen::VectorXd dense(const RowOf<Spatial>& row, Eigen::Index dof) {
  constexpr int n = Spatial::kVelocities;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(dof);
  for (const auto& [body, entries] : {std::pair{row.a, row.ja}, std::pair{row.b, row.jb}})
    for (int k = 0; body >= 0 && k < n; ++k) all[n * body + k] += entries[static_cast<std::size_t>(k)];
  return all;
}

}  // namespace

ClosedRows closed_rows(const spatial::Scene& scene, const State& x, double gap) {
  const SystemOf<Spatial> system(scene);
  TermsOf<Spatial> terms(system);
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_rows(system, terms), evaluate_gaps(system, terms), evaluate_closed(system, gap, terms);
  ClosedRows all;
  all.inverse_mass = system.inverse_mass();
  for (const auto& row : terms.G) all.joints.push_back(dense(row, system.dof()));
  for (const auto& c : terms.closed) {
    const ContactLaw& law = system.law(c.contact);
    const auto slip = slip_rate(c.rows, x.v.data()) - belt_of(law, c.rows);
    ClosedContactRows rows{c.contact, law, terms.gap[c.contact], dense(c.rows.normal, system.dof()), {}, {}, {}};
    rows.slip.resize(Spatial::kTangents);
    for (std::size_t i = 0; i < Spatial::kTangents; ++i) {
      rows.tangents.push_back(dense(c.rows.tangents[i], system.dof()));
      rows.direction.emplace_back(spatial::direction_of(c.rows.tangents[i]));
      rows.slip[static_cast<Eigen::Index>(i)] = tangent_part(slip, i);
    }
    all.contacts.push_back(std::move(rows));
  }
  return all;
}

}  // namespace orthant::motion_storm
