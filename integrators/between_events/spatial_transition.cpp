#include <orthant/integrators/between_events/spatial_transition.h>

#include <algorithm>
#include <cmath>

namespace orthant {

SpatialTransition::SpatialTransition(const SystemOf<Spatial>& system)
    : system_(system), equations_(system, 3 * system.scene().contacts.size()) {}

/// Rows: the normals of all candidates, then the tangents of those with friction that do not slide.
void SpatialTransition::formulate(SpatialMotion& motion, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  constexpr double kImmobile = 1e-12;  // of the coupling without joints
  contacts_.clear(), rows_.clear(), equations_.clear(), lcp_.friction.clear();
  for (const Candidate& c : candidates) contacts_.push_back(c.contact);
  evaluate_closed(system_, contacts_, motion.terms());
  std::vector<RowOf<Spatial>> all;
  std::vector<SpatialMotion::Bias> biases;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    const ContactRowsOf<Spatial>& rows = motion.terms().closed[i].rows;
    rows_.push_back(rows), biases.push_back(motion.bias(c.contact, q, v));
    RowOf<Spatial> force = rows.normal;
    if (c.slides) {
      const Tangents along = along_tangents(rows, c.direction);
      const double mu = system_.law(c.contact).mu;
      force = combined(force, -mu * along.first, rows.tangents[0]);
      force = combined(force, -mu * along.second, rows.tangents[1]);
    }
    equations_.add(rows.normal, force, biases[i].normal);
    all.push_back(rows.normal);
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const double mu = static_friction(system_.law(candidates[i].contact));
    if (candidates[i].slides || mu <= 0) continue;
    lcp_.friction.push_back({.normal = static_cast<Index>(i), .first = equations_.size(), .rows = 2, .mu = mu});
    for (std::size_t k = 0; k < 2; ++k) {
      equations_.add(rows_[i].tangents[k], rows_[i].tangents[k], tangent_part(biases[i].tangent, k));
      all.push_back(rows_[i].tangents[k]);
    }
  }
  equations_.assemble(motion.basic(), motion.free());
  const Index n = equations_.size(), normals = static_cast<Index>(candidates.size());
  for (Index i = 0; i < n; ++i) {
    const RowOf<Spatial>& row = all[static_cast<std::size_t>(i)];
    const double free = coupling(row, row, system_.inverse_mass());
    if (equations_.A(i, i) > kImmobile * free || (i < normals && candidates[static_cast<std::size_t>(i)].slides))
      continue;
    equations_.A.row(i).setZero(), equations_.A.col(i).setZero();
    equations_.A(i, i) = free > 0 ? free : 1, equations_.b[i] = 0;
  }
  std::get<DenseMatrix>(lcp_.A) = equations_.A;
  lcp_.b = equations_.b;
  lcp_.lo.resize(n), lcp_.hi.resize(n);
  lcp_.hi.setConstant(kInf), lcp_.lo.setConstant(-kInf);
  lcp_.lo.head(normals).setZero();
}

/// [m/s²] what rounding makes of accelerations that are zero.
double SpatialTransition::zero() const {
  return std::max(1e-12 * lcp_.b.lpNorm<Eigen::Infinity>(), 32 * solution_.rounding);
}

/// Contacts whose friction is at its bound slide from now on. True: with another coefficient, to be solved again.
bool SpatialTransition::slide_off() {
  bool again = false;
  const double zero = this->zero();
  for (const Friction& f : lcp_.friction) {
    const Tangents force{solution_.z[f.first], solution_.z[f.first + 1]},
        slip{solution_.w[f.first], solution_.w[f.first + 1]};
    const double slack = f.mu * solution_.z[f.normal] - size_of(force);
    const double stiff = std::max(equations_.A(f.first, f.first), equations_.A(f.first + 1, f.first + 1));
    if (size_of(slip) <= stiff * std::max(slack, 0.0) + zero) continue;
    Candidate& c = candidates[static_cast<std::size_t>(f.normal)];
    const auto& tangents = rows_[static_cast<std::size_t>(f.normal)].tangents;
    c.slides = c.departs = true;
    c.direction = (slip.first * direction_of(tangents[0]) + slip.second * direction_of(tangents[1])) / size_of(slip);
    again = again || system_.law(c.contact).mu != f.mu;
  }
  return again;
}

Status SpatialTransition::decide(SpatialMotion& motion, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                 Solver& solver, StepReport& report) {
  lcp_.b.resize(0), why_.clear();
  if (!candidates.empty()) {
    do {
      formulate(motion, q, v);
      solver.solve(lcp_, solution_);
      refinement_.improve(lcp_, solution_);
      const double velocity_residual = report.lcp_residual;  // that one is in m/s, not m/s²
      report.note(lcp_, solution_);
      report.lcp_residual = velocity_residual;
      if (report.status != Status::solved) {
        why_ = solution_.status == Status::infeasible
                   ? "no acceleration-level solution: friction and contact are inconsistent here (Painleve)"
                   : "the problem at acceleration level was not solved";
        return report.status;
      }
    } while (slide_off());
  }
  std::fill(motion.modes.begin(), motion.modes.end(), SpatialMode{});
  const double zero = lcp_.size() > 0 ? this->zero() : 0;
  const double most = candidates.empty() ? 0 : solution_.z.head(static_cast<Index>(candidates.size())).maxCoeff();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const Candidate& c = candidates[i];
    const double push = equations_.A(row, row) * solution_.z[row];
    SpatialMode& mode = motion.modes[static_cast<std::size_t>(c.contact)];
    mode.lasting = push > solution_.w[row] && push > zero;
    if (!mode.lasting) continue;
    mode.slides = c.slides, mode.departs = c.departs, mode.departure = c.direction;
    mode.sticks = !c.slides && static_friction(system_.law(c.contact)) > 0;
    mode.share_normal = std::max(solution_.z[row], 1e-3 * most);  // none so small that it counts as dependent
    mode.share_tangent = static_friction(system_.law(c.contact)) * mode.share_normal;
  }
  motion.modes_changed();
  return Status::solved;
}

}  // namespace orthant
