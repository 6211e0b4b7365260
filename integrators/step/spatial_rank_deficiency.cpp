#include <orthant/integrators/step/spatial_rank_deficiency.h>

namespace orthant {

bool SpatialRankDeficiency::find(const StepProblem& problem) {
  constexpr double kImmobile = 1e-12;
  if (system_.joint_rows() == 0 || problem.form() == Form::full || problem.no_normal() >= 0) return false;
  const auto immobile = [&](Index row) {
    const RowOf<Spatial>& J = problem.rows()[static_cast<std::size_t>(row)];
    return problem.entry(row, row) <= kImmobile * coupling(J, J, system_.inverse_mass());
  };
  problem.each_contact([&](Index normal, Index edge, Index tangent, const StepProblem::Contact& c) {
    // Of edges: opposite ones n ± μ t and, square to them, n ± μ s that are all immobile leave n so.
    const Index quarter = StepProblem::kEdges / 4;
    const bool held = immobile(normal) && (edge < 0 || (immobile(edge) && immobile(normal + quarter)));
    if (!held && !(tangent >= 0 && immobile(tangent) && immobile(tangent + 1))) return;
    held_.resize(terms_->closed.size(), Held::nowhere);
    held_[c.closed] = held ? Held::normal : Held::tangent;
  });
  return !held_.empty();
}

}  // namespace orthant
