#include <orthant/integrators/between_events/contact_transition.h>
#include <orthant/integrators/between_events/transition_words.h>
#include <orthant/solvers/pivoting/enumerate.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {

ContactTransition::ContactTransition(const System& system)
    : system_(system), immobility_(system), equations_(system, 2 * system.scene().contacts.size()) {
  candidates.reserve(system.scene().contacts.size());
  rows_.reserve(system.scene().contacts.size());
}

/// Contacts that joints immobilise are no candidates: no force moves them, and they go where the joints take them.
void ContactTransition::leave_out_immobile(ContactMotion& motion) {
  if (candidates.empty() || !immobility_.stand(motion.terms().at) || system_.joint_rows() == 0) return;
  std::erase_if(candidates, [&](Candidate& c) {
    const ContactRows rows = immobility_.rows(c.contact);
    if (immobility_.look(rows.normal).immobile) return true;
    c.held = c.slip == 0 && system_.law(c.contact).frictional() && immobility_.look(rows.tangent).immobile;
    return false;
  });
}

/// Rows: the normals of all candidates, then the tangents of those with friction that do not slide.
void ContactTransition::formulate(ContactMotion& motion) {
  Terms& terms = motion.terms();
  terms.closed.clear();
  equations_.clear(), rows_.clear(), lcp_.friction.clear();
  for (const Candidate& c : candidates) {
    std::visit(
        [&](const auto& contact) {
          const ContactRows rows = contact.rows(terms.at);
          rows_.push_back(rows);
          const double mu = c.slip * contact.law.mu;
          if (mu != 0)
            equations_.add_sliding(rows, mu, contact.bias(terms.at).normal);
          else
            equations_.add(rows.normal, rows.normal, contact.bias(terms.at).normal);
        },
        system_.scene().contacts[static_cast<std::size_t>(c.contact)]);
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const double mu = static_mu(system_.law(candidates[i].contact));
    if (candidates[i].slip != 0 || candidates[i].held || mu <= 0) continue;
    lcp_.friction.push_back({.normal = static_cast<Index>(i), .first = equations_.size(), .mu = mu});
    std::visit(
        [&](const auto& contact) {
          equations_.add(rows_[i].tangent, rows_[i].tangent, contact.bias(terms.at).tangent);
        },
        system_.scene().contacts[static_cast<std::size_t>(candidates[i].contact)]);
  }
  equations_.assemble(motion.basic(), motion.free());
  const Index n = equations_.size(), normals = static_cast<Index>(candidates.size());
  as<DenseMatrix>(lcp_.A) = equations_.A;
  lcp_.b = equations_.b;
  lcp_.lo.resize(n), lcp_.hi.resize(n);
  lcp_.hi.setConstant(kInf), lcp_.lo.setConstant(-kInf);
  lcp_.lo.head(normals).setZero();
}

/// More than one solution, or none, is possible already for one contact by itself.
bool ContactTransition::doubtful() const {
  const auto normals = static_cast<Index>(candidates.size());
  for (Index i = 0; i < normals; ++i)
    if (equations_.A(i, i) <= 0) return true;
  for (const Friction& f : lcp_.friction)
    if (equations_.A(f.normal, f.normal) <= f.mu * std::abs(equations_.A(f.normal, f.first))) return true;
  return false;
}

/// Whether no force moves the combination of normals u.
bool ContactTransition::immobile(const Vector& u) {
  immobility_.begin();
  for (std::size_t i = 0; i < candidates.size(); ++i) immobility_.add(rows_[i].normal, u[static_cast<Index>(i)]);
  return immobility_.judge().immobile;
}

/// Whether the certificate u stands against rounding of the problem too. A row that no force moves contradicts by its
/// own accelerations alone, more than by rounding. Else every column's share of Aᵀu has to be clearly below zero, or of
/// nothing:
/// where it is zero by rounding, large forces may be the answer and not none: blocks whose masses lie far apart, or a
/// light body between heavy ones, whose contacts are out of line by rounding alone.
ContactTransition::Proof ContactTransition::proof() {
  constexpr double kProof = 1e-8;
  const Vector& u = solution_.certificate.size() > 0 ? solution_.certificate : solution_.ray;
  if (solution_.status != Status::infeasible || u.size() != lcp_.size() ||  // or searched: no such combination
      lcp_.b.dot(u) >= -kProof * lcp_.b.lpNorm<Eigen::Infinity>() * u.lpNorm<1>())
    return Proof::none;
  if (immobile(u)) return Proof::immobile;
  for (Index i = 0; i < static_cast<Index>(candidates.size()); ++i) {
    const auto share = [&](Index row) { return equations_.A.col(row).dot(u); };
    const auto size = [&](Index row) { return equations_.A.col(row).cwiseAbs().dot(u.cwiseAbs()); };
    double sum = share(i), all = size(i);
    for (const Friction& f : lcp_.friction)
      if (f.normal == i) sum += f.mu * std::abs(share(f.first)), all += f.mu * size(f.first);
    if (sum > -kProof * all) return Proof::none;
  }
  return Proof::paradox;
}

/// Accelerations of a combination that no force moves are what joints and the turning of normals make them: where they
/// are inconsistent all the same, and no drive does it, targets give way. True: to be solved once more.
bool ContactTransition::relax() {
  constexpr double kSlack = 1e-12;
  const auto& u = solution_.certificate.size() > 0 ? solution_.certificate : solution_.ray;
  if (has_answer(solution_.status) || system_.driven() || u.size() != lcp_.size() || !immobile(u)) return false;
  const auto own = u.head(static_cast<Index>(candidates.size())).cwiseMax(0);
  const double missing = kSlack * u.cwiseAbs().dot(lcp_.b.cwiseAbs()) - u.dot(lcp_.b), square = own.squaredNorm();
  if (!(missing > 0) || !(square > 0) || !std::isfinite(missing)) return false;
  lcp_.b.head(own.size()) += missing / square * own;
  return true;
}

/// The judge's status, `unsupported` for several solutions; why_ says so in words.
Status ContactTransition::examine(Solver& solver, const Eigen::VectorXd& free) {
  constexpr Index kMostRows = 12;
  constexpr int kPasses = 10;
  why_.clear(), undecided_ = false;
  for (int pass = 0; pass == 0 || (pass < kPasses && relax()); ++pass) solver.solve(lcp_, solution_);
  refinement_.improve(lcp_, solution_);
  Proof proved = proof();
  if (!has_answer(solution_.status) && proved == Proof::none) second_.solve(lcp_, solution_), proved = proof();
  const Vector& contradiction = solution_.certificate.size() > 0 ? solution_.certificate : solution_.ray;
  if (proved == Proof::paradox) why_ = kNoAcceleration;
  if (proved == Proof::immobile) why_ = contacts_together("no motion satisfies", system_, candidates, contradiction);
  if (proved != Proof::none) return solution_.status;
  if (has_answer(solution_.status) && !doubtful()) return Status::solved;
  SolutionSet set;
  if (lcp_.size() <= kMostRows && finite(lcp_)) set = enumerate_solutions(lcp_);
  std::vector<Vector> found = set.isolated;
  for (const SolutionFace& face : set.faces) found.insert(found.end(), face.vertices.begin(), face.vertices.end());
  const std::vector<Vector> different = with_different_accelerations(found, equations_, lcp_.b, free);
  if (different.size() > 1) {
    why_ = several_in_words(different, candidates.size());
    return Status::unsupported;
  }
  undecided_ = !has_answer(solution_.status);
  if (undecided_) {
    why_ = solution_.status == Status::infeasible
               ? contacts_together("rounding leaves undecided whether accelerations satisfy", system_, candidates,
                                   contradiction)
               : std::string(kNotSolved);
    if (solution_.status == Status::infeasible) return Status::numerical_error;  // by rounding
  }
  return undecided_ ? solution_.status : Status::solved;
}

/// [m/s²] what rounding makes of accelerations that are zero.
double ContactTransition::zero() const {
  return std::max(kSame * lcp_.b.lpNorm<Eigen::Infinity>(), 32 * solution_.rounding);
}

/// Contacts whose friction is at its bound slide from now on. True: with another coefficient, to be solved again.
bool ContactTransition::slide_off() {
  bool again = false;
  const double zero = this->zero();
  for (const Friction& f : lcp_.friction) {
    const double slack = f.mu * solution_.z[f.normal] - std::abs(solution_.z[f.first]), slip = solution_.w[f.first];
    if (std::abs(slip) <= equations_.A(f.first, f.first) * slack + zero) continue;
    Candidate& c = candidates[static_cast<std::size_t>(f.normal)];
    c.slip = slip > 0 ? 1 : -1;
    again = again || system_.law(c.contact).mu != f.mu;
  }
  return again;
}

Status ContactTransition::decide(ContactMotion& motion, Solver& solver, StepReport& report) {
  lcp_.b.resize(0);
  leave_out_immobile(motion);
  if (!candidates.empty()) {
    do {
      formulate(motion);
      const double velocity_residual = report.lcp_residual;  // that one is in m/s, not m/s²
      const Status status = examine(solver, motion.free());
      report.note(lcp_, solution_);
      report.lcp_residual = velocity_residual;
      report.status = status;
      if (report.status != Status::solved) return report.status;
    } while (slide_off());
  }
  write_modes(motion, solution_, false);
  return Status::solved;
}

bool ContactTransition::find_forces_in_cones(ContactMotion& motion, Solver& solver, StepReport& report) {
  constexpr std::array kParts = {0.5, 0.8, 0.95, 0.99};
  if (lcp_.friction.empty() || !has_answer(solution_.status)) return false;
  Lcp part = lcp_;
  Solution found;
  for (const double share : kParts) {
    for (std::size_t i = 0; i < part.friction.size(); ++i) part.friction[i].mu = share * lcp_.friction[i].mu;
    solver.solve(part, found);
    report.lcp_solves += 1, report.lcp_iterations += found.iterations;
    if (!has_answer(found.status) ||
        with_different_accelerations({solution_.z, found.z}, equations_, lcp_.b, motion.free()).size() != 1)
      continue;
    write_modes(motion, found, true);
    return true;
  }
  return false;
}

void ContactTransition::write_modes(ContactMotion& motion, const Solution& solution, bool known) {
  std::fill(motion.modes.begin(), motion.modes.end(), ContactMode{});
  const double zero = lcp_.size() > 0 ? this->zero() : 0;
  const double most = candidates.empty() ? 0 : solution.z.head(static_cast<Index>(candidates.size())).maxCoeff();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const double push = equations_.A(row, row) * solution.z[row];
    ContactMode& mode = motion.modes[static_cast<std::size_t>(candidates[i].contact)];
    mode.lasting = push > solution.w[row] && push > zero;
    if (!mode.lasting) continue;
    mode.slip = candidates[i].slip;
    mode.share_normal = std::max(solution.z[row], 1e-3 * most);  // none so small that it counts as dependent
    mode.known = known, mode.known_normal = solution.z[row];
  }
  for (const Friction& f : lcp_.friction) {
    const Candidate& c = candidates[static_cast<std::size_t>(f.normal)];
    ContactMode& mode = motion.modes[static_cast<std::size_t>(c.contact)];
    mode.sticks = mode.lasting && c.slip == 0;
    mode.share_tangent = f.mu * mode.share_normal;
    mode.known_tangent = solution.z[f.first];
  }
  motion.modes_changed();
}

}  // namespace orthant
