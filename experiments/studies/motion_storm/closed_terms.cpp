#include "experiments/studies/motion_storm/closed_terms.h"

namespace orthant::motion_storm {

Terms closed_terms(const System& system, const State& x, double gap) {
  Terms terms(system);
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_rows(system, terms), evaluate_gaps(system, terms), evaluate_closed(system, gap, terms);
  return terms;
}

Eigen::VectorXd dense(const Row& row, Eigen::Index dof) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(dof);
  for (const auto& [body, entries] : {std::pair{row.a, row.ja}, std::pair{row.b, row.jb}})
    for (int k = 0; body >= 0 && k < 3; ++k) all[3 * body + k] += entries[static_cast<std::size_t>(k)];
  return all;
}

}  // namespace orthant::motion_storm
