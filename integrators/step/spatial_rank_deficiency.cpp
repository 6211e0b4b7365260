#include <orthant/integrators/step/spatial_rank_deficiency.h>

#include <cmath>

namespace orthant {

/// Of an immobile contact: in the step as a whole, as in the plane (rank_deficiency.cpp).
bool SpatialRankDeficiency::driven_inwards(const StepProblem::Contact& c) {
  constexpr double kBent = 0.1;  // of the change of the rate until the middle: what the rate there leaves out
  if (!system_.driven() || anchor_ == nullptr || c.index >= system_.listed()) return false;
  if (!immobility_) immobility_.emplace(system_);
  if (!immobility_->stand(*time_, *anchor_) || !immobility_->immobile(c.index)) return false;
  const double rate = immobility_->rate(), gap = immobility_->gap();
  if (!(rate < 0) || !(ahead_ > 0)) return rate < 0;
  if (!immobility_->begin(*terms_)) return true;
  immobility_->add(terms_->closed[c.closed].rows.normal, 1);
  const std::optional<double> middle = immobility_->rate_of_immobile(*terms_);
  return !middle || gap + ahead_ * *middle < -ahead_ * kBent * std::abs(*middle - rate);
}

bool SpatialRankDeficiency::find(const StepProblem& problem) {
  if (system_.joint_rows() == 0 || problem.form() == Form::full || problem.no_normal() >= 0) return false;
  const auto still = [&](Index row) {
    return immobile(problem.rows()[static_cast<std::size_t>(row)], problem.entry(row, row), system_.inverse_mass());
  };
  problem.each_contact([&](Index normal, Index edge, Index tangent, const StepProblem::Contact& c) {
    const auto entry = [&](Index i, Index j) { return problem.entry(i, j); };
    // Opposite edges n ± μ t have the mean n.
    const double own =
        edge < 0 ? entry(normal, normal) : (entry(normal, normal) + 2 * entry(normal, edge) + entry(edge, edge)) / 4;
    const bool held = immobile(terms_->closed[c.closed].rows.normal, own, system_.inverse_mass());
    if (!held && !(tangent >= 0 && still(tangent) && still(tangent + 1))) return;
    held_.resize(terms_->closed.size(), Held::nowhere);
    held_[c.closed] = !held ? Held::tangent : driven_inwards(c) ? Held::inwards : Held::normal;
  });
  return !held_.empty();
}

/// Relaxed cones ask a contact that slides to open. Where a proof has edges of cones, and its normals alone do not
/// contradict what drives do, another scheme or a shorter step may go on.
bool SpatialRankDeficiency::give_way(const StepProblem& problem, const Solution& solution, bool solved,
                                     StepReport& report) {
  const Vector& u = solution.certificate;
  if (solved || solution.status != Status::infeasible || u.size() != problem.size() || terms_ == nullptr) return false;
  if (!immobility_) immobility_.emplace(system_);
  if (!immobility_->begin(*terms_)) return false;
  bool edges = false;
  problem.each_contact([&](Index normal, Index edge, Index, const StepProblem::Contact& c) {
    const double push = u.segment(normal, edge >= 0 ? StepProblem::kEdges : 1).cwiseMax(0).sum();
    edges = edges || (edge >= 0 && push > kPartOfProof * u.lpNorm<Eigen::Infinity>());
    immobility_->add(terms_->closed[c.closed].rows.normal, push);
  });
  if (edges && !immobility_->driven_shut(*terms_)) relaxed_ = true, report.status = Status::stalled;
  return false;
}

}  // namespace orthant
